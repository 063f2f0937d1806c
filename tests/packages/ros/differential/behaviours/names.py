"""Names, namespaces, remapping and arguments."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.exceptions import NameValidationException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden
from rclpy.utilities import remove_ros_args
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_parameter_name import validate_parameter_name
from rclpy.validate_topic_name import validate_topic_name
from std_msgs.msg import Int32
from std_srvs.srv import Empty

from .declared import behaviour
from .graph import Graph, connect, raised

NAMES = "design.ros2.org/articles/topic_and_service_names.html"
REMAPPING = "design.ros2.org/articles/static_remapping.html"
ARGUMENTS = "design.ros2.org/articles/ros_command_line_arguments.html"


def _judged(validate: Callable[[str], Any], names: list[str]) -> dict[str, Any]:
    """True for a valid name, else the place of what is wrong."""
    found: dict[str, Any] = {}
    for name in names:
        try:
            found[name] = validate(name)
        except NameValidationException as error:
            found[name] = str(error).splitlines()[-1].index("^") - 3
    return found


@behaviour(
    expected={
        "foo": True,
        "abc123": True,
        "_foo": True,
        "Foo": True,
        "/foo": True,
        "/bar/baz": True,
        "~": True,
        "~/foo": True,
        "{foo}_bar": True,
        "foo/{ping}/bar": True,
        "123abc": 0,
        "/1a": 1,
        "": 0,
        "foo bar": 3,
        "foo/": 3,
        "foo/~": 4,
        "~foo": 1,
        "foo-bar": 3,
        "{foo": 0,
        "foo.bar": 3,
        "grüße": 2,
    },
    source=NAMES + ": ROS 2 name examples; the index is that of the first character that is wrong",
)
def names_of_topics() -> Any:
    names = [
        "foo",
        "abc123",
        "_foo",
        "Foo",
        "/foo",
        "/bar/baz",
        "~",
        "~/foo",
        "{foo}_bar",
        "foo/{ping}/bar",
        "123abc",
        "/1a",
    ]
    return _judged(
        validate_topic_name,
        [*names, "", "foo bar", "foo/", "foo/~", "~foo", "foo-bar", "{foo", "foo.bar", "grüße"],
    )


# the design has no empty tokens; rcl finds them in full names alone
@behaviour()
def two_slashes_in_a_name() -> Any:
    return [
        _judged(validate_topic_name, ["a//b"]),
        _judged(validate_full_topic_name, ["/a//b"]),
        expand_topic_name("a//b", "node", "/ns"),
        _judged(validate_namespace, ["/a//b"]),
    ]


@behaviour()
def names_of_nodes_namespaces_and_parameters() -> Any:
    return [
        _judged(
            validate_node_name, ["node", "_node", "node1", "1node", "no/de", "no de", "", "no.de", "x" * 300]
        ),
        _judged(validate_namespace, ["/", "/ns", "/ns/sub", "ns", "/ns/", "//ns", "", "/1ns", "/n s", "/~"]),
        _judged(validate_full_topic_name, ["/foo", "/foo/bar", "foo", "/foo/", "/~", "/{node}", "/"]),
        [raised(validate_parameter_name, name) for name in ("", "a", "a.b", "a b")],
    ]


@behaviour(
    expected=["/ns/chatter", "/chatter", "/ns/node", "/ns/node/chatter", "/ns/node_x", "/ns/x", "/node/y"],
    source=NAMES + ": relative, absolute and private names, substitutions",
)
def names_are_expanded() -> Any:
    names = ["chatter", "/chatter", "~", "~/chatter", "{node}_x", "{ns}/x", "/{node}/y"]
    return [expand_topic_name(name, "node", "/ns") for name in names]


@behaviour()
def names_that_cannot_be_expanded() -> Any:
    return [
        raised(expand_topic_name, "{unknown}", "node", "/ns"),
        raised(expand_topic_name, "a b", "node", "/ns"),
        raised(expand_topic_name, "a", "no de", "/ns"),
        raised(expand_topic_name, "a", "node", "n s"),
        expand_topic_name("a", "node", "/"),
    ]


@behaviour(
    expected=[
        "InvalidNodeNameException",
        "InvalidNodeNameException",
        "InvalidNamespaceException",
        "/a/b",
        "/",
    ],
    source="rclpy.exceptions; rclpy.node.Node: a namespace becomes absolute",
)
def nodes_with_names_that_are_wrong() -> Any:
    with Graph() as graph:
        return [
            raised(graph.node, "1node"),
            raised(graph.node, "a/b"),
            raised(graph.node, "node", namespace="a b"),
            graph.node("node", namespace="a/b").get_namespace(),
            graph.node("node", namespace="").get_namespace(),
        ]


@behaviour(
    expected=["InvalidTopicNameException", "InvalidTopicNameException", "InvalidServiceNameException", ""],
    source="rclpy.node.Node.create_publisher and the like: invalid names raise",
)
def publishers_and_services_with_names_that_are_wrong() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        return [
            raised(node.create_publisher, Int32, "a b", 1),
            raised(node.create_subscription, Int32, "/1", print, 1),
            raised(node.create_client, Empty, "x//y"),
            raised(node.create_publisher, Int32, "~/a", 1),
        ]


@behaviour(
    expected=["/ns/topic", "/topic", "/ns/node/topic", "node", "/ns", "/ns/node"],
    source=NAMES + ": relative, absolute and private names",
)
def names_of_a_node_and_its_publishers() -> Any:
    with Graph("node", namespace="/ns") as graph:
        (node,) = graph
        return [
            *(node.create_publisher(Int32, name, 1).topic_name for name in ("topic", "/topic", "~/topic")),
            node.get_name(),
            node.get_namespace(),
            node.get_fully_qualified_name(),
        ]


@behaviour(
    expected=["/bar", "/ns/x", "/node/z", "/untouched"],
    source=REMAPPING + ": match and replace fully qualified names; the first rule that matches",
)
def topics_are_remapped() -> Any:
    rules = ["foo:=bar", "/a:=/ns/x", "~/y:=~/z", "foo:=never"]
    args = ["--ros-args"] + [part for rule in rules for part in ("-r", rule)]
    with Graph("node", args=args) as graph:
        (node,) = graph
        return [
            node.create_publisher(Int32, name, 1).topic_name for name in ("foo", "/a", "~/y", "untouched")
        ]


@behaviour(
    expected=[["/new/other", "/new"], ["/new/topic"], "/other/private"],
    source=REMAPPING + ": __node, __name and __ns",
)
def nodes_are_renamed() -> Any:
    args = ["--ros-args", "-r", "__node:=other", "-r", "__ns:=/new"]
    with Graph("node", namespace="/old", args=args) as graph:
        (node,) = graph
        alone = graph.node("node", namespace="/old", use_global_arguments=False)
        assert alone.get_fully_qualified_name() == "/old/node"
        topic = node.create_publisher(Int32, "topic", 1).topic_name
        private = node.create_publisher(Int32, "~/private", 1).topic_name
        return [
            (node.get_fully_qualified_name(), node.get_namespace()),
            [topic],
            private.removeprefix("/new"),
        ]


@behaviour(
    expected=["/renamed", "/topic", "/two_renamed"],
    source=REMAPPING + ": a rule may name the node that it is for",
)
def rules_for_one_node() -> Any:
    args = ["--ros-args", "-r", "one:topic:=renamed", "-r", "two:__node:=two_renamed"]
    with Graph("one", "other", "two", args=args) as graph:
        first_node, second_node, third_node = graph
        return [
            first_node.create_publisher(Int32, "topic", 1).topic_name,
            second_node.create_publisher(Int32, "topic", 1).topic_name,
            third_node.get_fully_qualified_name(),
        ]


@behaviour(
    expected=[["/t", "/plain"], ["/plain", "/s"]], source=REMAPPING + ": rostopic:// and rosservice:// rules"
)
def rules_for_topics_or_services() -> Any:
    args = ["--ros-args", "-r", "rostopic://a:=/t", "-r", "rosservice://b:=/s", "-r", "plain:=/plain"]
    with Graph("node", args=args) as graph:
        (node,) = graph
        topics = {name: node.create_publisher(Int32, name, 1).topic_name for name in ("a", "plain")}
        services = {name: node.create_service(Empty, name, print).service_name for name in ("plain", "b")}
        assert node.create_publisher(Int32, "b", 1).topic_name == "/b"
        return list(topics.values()), list(services.values())


@behaviour()
def a_publisher_and_a_subscription_meet_by_remapping() -> Any:
    with Graph("talker", args=["--ros-args", "-r", "out:=/shared"]) as graph:
        (talker,) = graph
        listener = graph.node("listener", cli_args=["--ros-args", "-r", "in:=/shared"])
        heard: list[int] = []
        listener.create_subscription(Int32, "in", lambda message: heard.append(message.data), 10)
        publisher = talker.create_publisher(Int32, "out", 10)
        connect(graph, publisher)
        publisher.publish(Int32(data=3))
        graph.until(lambda: heard)
        return heard, publisher.topic_name, dict(listener.get_topic_names_and_types())["/shared"]


@behaviour()
def names_are_resolved() -> Any:
    with Graph("node", namespace="/ns", args=["--ros-args", "-r", "foo:=bar"]) as graph:
        (node,) = graph
        return [
            node.resolve_topic_name("foo"),
            node.resolve_topic_name("foo", only_expand=True),
            node.resolve_service_name("foo"),
            node.resolve_service_name("~/x"),
            raised(node.resolve_topic_name, "a b"),
        ]


@behaviour(
    expected=[["program", "own", "--flag"], ["program"], ["program", "after"]],
    source=ARGUMENTS + ": --ros-args until -- or the end",
)
def arguments_of_ros_are_removed() -> Any:
    return [
        remove_ros_args(["program", "own", "--flag"]),
        remove_ros_args(["program", "--ros-args", "-r", "a:=b", "-p", "x:=1"]),
        remove_ros_args(["program", "--ros-args", "-r", "a:=b", "--", "after"]),
    ]


@behaviour()
def arguments_that_are_wrong() -> Any:
    found = []
    for arguments in (
        ["-r", "a"],
        ["-r", "a b:=c"],
        ["-p", "x"],
        ["--unknown"],
        ["-r"],
        ["--log-level", "loud"],
        ["-p", "x:=[1, a]"],
    ):
        context = rclpy.context.Context()
        found.append(raised(rclpy.init, args=["--ros-args", *arguments], context=context))
        context.try_shutdown()
    return found


@behaviour(
    expected=[True, True, False, False], source=NAMES + ": hidden names have a token that begins with _"
)
def hidden_names() -> Any:
    return [topic_or_service_is_hidden(name) for name in ("/_a", "/a/_b/c", "/a", "/a_b")]


@behaviour()
def two_nodes_of_one_name() -> Any:
    with Graph("twin", "twin", "watcher") as graph:
        first, second, watcher = graph
        heard: list[str] = []
        first.create_subscription(Int32, "n", lambda message: heard.append("first"), 1)
        second.create_subscription(Int32, "n", lambda message: heard.append("second"), 1)
        publisher = watcher.create_publisher(Int32, "n", 1)
        connect(graph, publisher, 2)
        publisher.publish(Int32())
        graph.until(lambda: len(heard) == 2)
        return sorted(heard), watcher.get_node_names().count("twin")
