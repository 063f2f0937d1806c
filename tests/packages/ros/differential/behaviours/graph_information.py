"""What a node can learn about the graph."""

from __future__ import annotations

from typing import Any

from rclpy.node import Node
from rclpy.type_description_service import START_TYPE_DESCRIPTION_SERVICE_PARAM
from std_msgs.msg import Int32, String
from std_srvs.srv import Empty, SetBool
from type_description_interfaces.srv import GetTypeDescription

from .declared import behaviour
from .graph import Graph, raised, ready


@behaviour(
    expected=[[["/arm/one", "/two"], ["/arm", "/"]], ["/arm/one", "/two"]],
    source="rclpy.node.Node: get_node_names_and_namespaces, get_fully_qualified_node_names",
)
def nodes_are_listed() -> Any:
    with Graph() as graph:
        first_node = graph.node("one", namespace="arm")
        graph.node("two")
        found = sorted(first_node.get_node_names_and_namespaces())
        names = [f"{space.rstrip('/')}/{name}" for name, space in found]
        return (names, [space for _, space in found]), sorted(first_node.get_fully_qualified_node_names())


@behaviour()
def enclaves_of_nodes() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        return node.get_node_names_and_namespaces_with_enclaves()


@behaviour()
def topics_are_listed_with_their_types() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.create_publisher(Int32, "a", 1)
        node.create_subscription(String, "b", print, 1)
        graph.until(lambda: node.count_subscribers("b"))
        return sorted(node.get_topic_names_and_types())


@behaviour()
def services_are_listed_with_their_types() -> Any:
    with Graph("node", start_parameter_services=False) as graph:
        (node,) = graph
        node.create_service(SetBool, "a", print)
        node.create_client(Empty, "b")
        graph.until(lambda: node.count_clients("b"))
        return sorted(node.get_service_names_and_types())


@behaviour()
def the_endpoints_of_a_node() -> Any:
    with Graph("node", "watcher", start_parameter_services=False) as graph:
        node, watcher = graph
        node.create_publisher(Int32, "said", 1)
        node.create_subscription(String, "heard", print, 1)
        node.create_service(SetBool, "served", print)
        node.create_client(Empty, "asked")
        graph.until(lambda: watcher.count_clients("asked"))
        return {
            "publishers": sorted(watcher.get_publisher_names_and_types_by_node("node", "/")),
            "subscriptions": sorted(watcher.get_subscriber_names_and_types_by_node("node", "/")),
            "services": sorted(watcher.get_service_names_and_types_by_node("node", "/")),
            "clients": sorted(watcher.get_client_names_and_types_by_node("node", "/")),
        }


@behaviour(
    expected="NodeNameNonExistentError",
    source="rclpy.node.Node.get_publisher_names_and_types_by_node: raises NodeNameNonExistentError",
)
def the_endpoints_of_a_node_that_is_not_there() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        return raised(node.get_publisher_names_and_types_by_node, "other", "/")


@behaviour(
    expected=[[0, 0], [1, 2], [1, 1]],
    source="rclpy.node.Node: count_publishers and count_subscribers of a topic",
)
def endpoints_are_counted() -> Any:
    with Graph("node") as graph:
        (node,) = graph

        def counts() -> tuple[int, int]:
            return node.count_publishers("topic"), node.count_subscribers("/topic")

        seen = [counts()]
        node.create_publisher(Int32, "topic", 1)
        subscriptions = [node.create_subscription(Int32, "topic", print, 1) for _ in range(2)]
        graph.until(lambda: counts() == (1, 2))
        seen.append(counts())
        node.destroy_subscription(subscriptions[0])
        graph.until(lambda: counts() == (1, 1))
        return [*seen, counts()]


@behaviour()
def information_about_endpoints() -> Any:
    with Graph() as graph:
        first_node = graph.node("one", namespace="/arm")
        second_node = graph.node("two")
        first_node.create_publisher(Int32, "/topic", 3)
        second_node.create_subscription(Int32, "topic", print, 7)
        graph.until(lambda: first_node.count_publishers("/topic") and first_node.count_subscribers("/topic"))
        (publisher,) = second_node.get_publishers_info_by_topic("/topic")
        (subscription,) = second_node.get_subscriptions_info_by_topic("topic")
        return [
            [
                info.node_name,
                info.node_namespace,
                info.topic_type,
                info.endpoint_type.name,
                len(info.endpoint_gid),
                str(info.topic_type_hash),
            ]
            for info in (publisher, subscription)
        ]


@behaviour()
def information_about_a_topic_that_is_not_there() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        return [
            node.get_publishers_info_by_topic("/none"),
            node.get_subscriptions_info_by_topic("/none"),
            raised(node.get_publishers_info_by_topic, "a b"),
            node.count_publishers("none"),
        ]


@behaviour(expected=[True, True, False], source="rclpy.node.Node.wait_for_node: True if the node was found")
def a_node_that_ends_leaves_the_graph() -> Any:
    with Graph("watcher") as graph:
        (watcher,) = graph
        other = Node("other", context=graph.context)
        found = watcher.wait_for_node("other", 5.0)
        other.destroy_node()
        gone = graph.until(lambda: "other" not in watcher.get_node_names())
        return found, gone, watcher.wait_for_node("/other", 0.3)


@behaviour()
def what_a_node_has_by_default() -> Any:
    with Graph("node", "bare") as graph:
        node, _ = graph
        quiet = graph.node("quiet", enable_rosout=False, start_parameter_services=False)
        return [
            sorted(node.get_publisher_names_and_types_by_node("node", "/")),
            sorted(node.get_subscriber_names_and_types_by_node("node", "/")),
            sorted(node.get_publisher_names_and_types_by_node("quiet", "/")),
            len(list(node.publishers)),
            len(list(node.services)),
            len(list(quiet.services)),
            len(list(node.timers)),
        ]


@behaviour()
def a_node_under_simulated_time_listens_to_the_clock() -> Any:
    with Graph("node", args=["--ros-args", "-p", "use_sim_time:=true"]) as graph:
        (node,) = graph
        graph.until(lambda: node.count_subscribers("/clock"))
        (info,) = node.get_subscriptions_info_by_topic("/clock")
        return info.topic_type, info.qos_profile.reliability.name, info.qos_profile.durability.name


@behaviour()
def the_description_of_a_type() -> Any:
    with Graph("node", "asker") as graph:
        node, asker = graph
        node.create_publisher(Int32, "numbers", 1)
        graph.until(lambda: asker.count_publishers("numbers"))
        (info,) = asker.get_publishers_info_by_topic("/numbers")
        client = asker.create_client(GetTypeDescription, "node/get_type_description")
        ready(graph, client)
        request = GetTypeDescription.Request(
            type_name="std_msgs/msg/Int32", type_hash=str(info.topic_type_hash), include_type_sources=False
        )
        answer = graph.result(client.call_async(request))
        fields = answer.type_description.type_description.fields
        unknown = graph.result(
            client.call_async(
                GetTypeDescription.Request(type_name="no/msg/Type", type_hash=request.type_hash)
            )
        )
        return [
            answer.successful,
            answer.type_description.type_description.type_name,
            [(field.name, field.type.type_id) for field in fields],
            unknown.successful,
            node.has_parameter(START_TYPE_DESCRIPTION_SERVICE_PARAM),
        ]
