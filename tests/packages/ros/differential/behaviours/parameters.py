"""Parameters, their callbacks and their services."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterEvent,
    ParameterType,
    SetParametersResult,
)
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler

from .declared import behaviour
from .graph import Graph, raised

PARAMETERS = "docs.ros.org, Concepts, Parameters"


def settled(results: list[SetParametersResult]) -> list[bool]:
    """Which parameters were set."""
    return [result.successful for result in results]


@behaviour(
    expected=[
        ["BOOL", "INTEGER", "DOUBLE", "STRING"],
        ["BYTE_ARRAY", "BOOL_ARRAY", "INTEGER_ARRAY", "DOUBLE_ARRAY", "STRING_ARRAY"],
    ],
    source=PARAMETERS + ": the types of parameters",
)
def parameters_have_types() -> Any:
    values = [True, 7, 1.5, "text"]
    arrays = [[b"\x01", b"\x02"], [True, False], [1, 2], [1.0, 2.0], ["a", "b"]]
    with Graph("node") as graph:
        (node,) = graph
        return [
            [node.declare_parameter(f"{kind}{index}", value).type_.name for index, value in enumerate(group)]
            for kind, group in (("value", values), ("array", arrays))
        ]


@behaviour(
    expected=[
        "ParameterAlreadyDeclaredException",
        "ParameterNotDeclaredException",
        "ParameterNotDeclaredException",
    ],
    source="rclpy.node.Node: declare_parameter, get_parameter and set_parameters raise",
)
def parameters_are_declared_once_and_before_use() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("one", 1)
        return [
            raised(node.declare_parameter, "one", 2),
            raised(node.get_parameter, "two"),
            raised(node.set_parameters, [Parameter("two", value=1)]),
        ]


@behaviour()
def undeclared_parameters_can_be_allowed() -> Any:
    with Graph("node", allow_undeclared_parameters=True) as graph:
        (node,) = graph
        unset = node.get_parameter("two")
        results = settled(node.set_parameters([Parameter("two", value=1)]))
        return (
            unset.type_.name,
            unset.value,
            results,
            node.get_parameter("two").value,
            node.has_parameter("three"),
        )


@behaviour(
    expected=[[False, True], 2, [True], "text"],
    source=PARAMETERS + ": the type cannot change, unless dynamic_typing is set",
)
def a_parameter_keeps_its_type() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("one", 1)
        node.declare_parameter("any", 1, ParameterDescriptor(dynamic_typing=True))
        results = settled(node.set_parameters([Parameter("one", value="x"), Parameter("one", value=2)]))
        changed = settled(node.set_parameters([Parameter("any", value="text")]))
        return results, node.get_parameter("one").value, changed, node.get_parameter("any").value


@behaviour()
def an_integer_is_no_double() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("speed", 1.0)
        (result,) = node.set_parameters([Parameter("speed", value=2)])
        overridden = Parameter("other", value=2)
        other = graph.node("other", parameter_overrides=[overridden])
        return (
            result.successful,
            node.get_parameter("speed").value,
            raised(other.declare_parameter, "other", 1.0),
        )


@behaviour(
    expected=[[False], 1, "ParameterImmutableException"],
    source="rcl_interfaces/ParameterDescriptor, read_only: the value cannot change",
)
def a_parameter_can_be_read_only() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("one", 1, ParameterDescriptor(read_only=True))
        results = settled(node.set_parameters([Parameter("one", value=2)]))
        return results, node.get_parameter("one").value, raised(node.undeclare_parameter, "one")


@behaviour(
    expected=[[True, False, False, True], [True, False, True], "InvalidParameterValueException"],
    source="rcl_interfaces/IntegerRange and FloatingPointRange: from, to, step",
)
def a_parameter_can_have_a_range() -> Any:
    integers = ParameterDescriptor(integer_range=[IntegerRange(from_value=0, to_value=10, step=2)])
    numbers = ParameterDescriptor(
        floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0, step=0.5)]
    )
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("even", 0, integers)
        node.declare_parameter("half", 0.0, numbers)
        return [
            settled(node.set_parameters([Parameter("even", value=value) for value in (4, 3, 12, 10)])),
            settled(node.set_parameters([Parameter("half", value=value) for value in (0.5, 0.4, 1.0)])),
            raised(node.declare_parameter, "odd", 3, integers),
        ]


@behaviour(
    expected=["too fast", 1.0, 2.0, 5.0],
    source="rclpy.node.Node.add_on_set_parameters_callback: a callback accepts or rejects",
)
def setting_a_parameter_can_be_refused() -> Any:
    def choose(parameters: list[Parameter]) -> SetParametersResult:
        is_slow = all(parameter.value < 3.0 for parameter in parameters)
        return SetParametersResult(successful=is_slow, reason="" if is_slow else "too fast")

    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("speed", 1.0)
        node.add_on_set_parameters_callback(choose)
        (refused,) = node.set_parameters([Parameter("speed", value=5.0)])
        before = node.get_parameter("speed").value
        node.set_parameters([Parameter("speed", value=2.0)])
        after = node.get_parameter("speed").value
        node.remove_on_set_parameters_callback(choose)
        node.set_parameters([Parameter("speed", value=5.0)])
        return refused.reason, before, after, node.get_parameter("speed").value


@behaviour(
    expected=[["pre", "on", "post"], 1, 2],
    source="rclpy.node.Node: pre-set callbacks may change the list, on-set ones refuse",
)
def callbacks_come_before_at_and_after_setting() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("one", 0)
        node.declare_parameter("two", 0)
        order: list[str] = []

        def before(parameters: list[Parameter]) -> list[Parameter]:
            order.append("pre")
            return [*parameters, Parameter("two", value=2)]

        def at(parameters: list[Parameter]) -> SetParametersResult:
            order.append("on")
            return SetParametersResult(successful=True)

        node.add_pre_set_parameters_callback(before)
        node.add_on_set_parameters_callback(at)
        node.add_post_set_parameters_callback(lambda parameters: order.append("post"))
        node.set_parameters([Parameter("one", value=1)])
        return order, node.get_parameter("one").value, node.get_parameter("two").value


@behaviour()
def callbacks_are_called_from_the_last_to_the_first() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("one", 0)
        order: list[str] = []

        def choosing(name: str, successful: bool) -> Any:
            def choose(parameters: list[Parameter]) -> SetParametersResult:
                order.append(name)
                return SetParametersResult(successful=successful, reason=name)

            return choose

        for name, successful in (("first", True), ("second", False), ("third", True)):
            node.add_on_set_parameters_callback(choosing(name, successful))
        (result,) = node.set_parameters([Parameter("one", value=1)])
        return order, result.reason, node.get_parameter("one").value


@behaviour(
    expected=[False, [0, 0], True, [1, 2]],
    source="rclpy.node.Node.set_parameters_atomically: if any is rejected, none is set",
)
def parameters_are_set_together_or_not_at_all() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameters("", [("one", 0), ("two", 0)])
        wrong = node.set_parameters_atomically([Parameter("one", value=1), Parameter("two", value="x")])
        before = [parameter.value for parameter in node.get_parameters(["one", "two"])]
        right = node.set_parameters_atomically([Parameter("one", value=1), Parameter("two", value=2)])
        after = [parameter.value for parameter in node.get_parameters(["one", "two"])]
        return wrong.successful, before, right.successful, after


@behaviour()
def a_parameter_is_undeclared() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("one", 1)
        node.undeclare_parameter("one")
        return (
            node.has_parameter("one"),
            raised(node.undeclare_parameter, "one"),
            node.declare_parameter("one", "x").value,
        )


@behaviour(
    expected=["ParameterUninitializedException", 5],
    source="rclpy.node.Node.get_parameter: raises if it is statically typed and unset",
)
def a_parameter_without_a_value() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("one", Parameter.Type.INTEGER)
        error = raised(node.get_parameter, "one")
        node.set_parameters([Parameter("one", value=5)])
        return error, node.get_parameter("one").value


@behaviour()
def a_default_for_what_is_not_there() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("one", 1)
        default = Parameter("two", value=9)
        return [
            node.get_parameter_or("two", default).value,
            node.get_parameter_or("one", default).value,
            node.get_parameter_or("three").value,
        ]


@behaviour(
    expected={"x": 1, "sub.y": 2},
    source="rclpy.node.Node.get_parameters_by_prefix: names without the prefix",
)
def parameters_of_a_prefix() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameters("arm", [("x", 1), ("sub.y", 2)])
        node.declare_parameter("armature", 3)
        return {name: parameter.value for name, parameter in node.get_parameters_by_prefix("arm").items()}


@behaviour()
def parameters_are_listed() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameters("", [("one", 1), ("arm.x", 1), ("arm.sub.y", 2)])
        return [
            (sorted(found.names), sorted(found.prefixes))
            for found in (
                node.list_parameters([], 0),
                node.list_parameters([], 1),
                node.list_parameters(["arm"], 1),
                node.list_parameters(["arm"], 2),
                node.list_parameters(["none"], 0),
            )
        ]


@behaviour(
    expected=[5, 1.5, "text", [1, 2], True],
    source="docs.ros.org, Passing ROS arguments via the command line: -p name:=value, in YAML",
)
def parameters_come_from_arguments() -> Any:
    args = ["--ros-args"]
    for text in ("whole:=5", "real:=1.5", "words:=text", "list:=[1, 2]", "flag:=true"):
        args += ["-p", text]
    with Graph("node", args=args) as graph:
        (node,) = graph
        return [
            node.declare_parameter("whole", 0).value,
            node.declare_parameter("real", 0.0).value,
            node.declare_parameter("words", "").value,
            list(node.declare_parameter("list", [0]).value),
            node.declare_parameter("flag", False).value,
        ]


@behaviour(
    expected=[1, 2],
    source="docs.ros.org, Passing ROS arguments: node_name:param:=value is for that node alone",
)
def parameters_for_one_node() -> Any:
    with Graph("one", "two", args=["--ros-args", "-p", "n:=1", "-p", "two:n:=2"]) as graph:
        return [node.declare_parameter("n", 0).value for node in graph]


@behaviour(
    expected=[[1, 5, "all"], [2, 0, "all"]],
    source="docs.ros.org, Passing ROS arguments, parameter files: /** stands for all nodes",
)
def parameters_come_from_a_file() -> Any:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "params.yaml"
        file.write_text(
            "/**:\n  ros__parameters:\n    who: all\n"
            "/arm/one:\n  ros__parameters:\n    n: 1\n    sub:\n      x: 5\n"
            "/arm/two:\n  ros__parameters:\n    n: 2\n"
        )
        with Graph("one", "two", namespace="arm", args=["--ros-args", "--params-file", str(file)]) as graph:
            return [
                [
                    node.declare_parameter(name, value).value
                    for name, value in (("n", 0), ("sub.x", 0), ("who", ""))
                ]
                for node in graph
            ]


@behaviour()
def overrides_of_the_program_and_of_the_command_line() -> Any:
    overrides = [Parameter("n", value=1)]
    with Graph("node", args=["--ros-args", "-p", "n:=2"], parameter_overrides=overrides) as graph:
        (node,) = graph
        return node.declare_parameter("n", 0).value, node.declare_parameter("m", 3).value


@behaviour()
def an_override_of_another_type() -> Any:
    with Graph("node", args=["--ros-args", "-p", "n:=text"]) as graph:
        (node,) = graph
        return (
            raised(node.declare_parameter, "n", 0),
            raised(node.declare_parameter, "m", 0),
            node.has_parameter("n"),
        )


@behaviour()
def overrides_are_declared_if_asked() -> Any:
    args = ["--ros-args", "-p", "a.b:=2", "-p", "c:=text"]
    with Graph("node", args=args, automatically_declare_parameters_from_overrides=True) as graph:
        (node,) = graph
        return [node.get_parameter(name).value for name in ("a.b", "c", "use_sim_time")]


@behaviour()
def an_override_can_be_ignored() -> Any:
    with Graph("node", args=["--ros-args", "-p", "n:=2"]) as graph:
        (node,) = graph
        alone = graph.node("alone", use_global_arguments=False)
        return node.declare_parameter("n", 1, ignore_override=True).value, alone.declare_parameter(
            "n", 1
        ).value


@behaviour(
    expected={"new": [["n", 1]], "changed": [["n", 2]], "deleted": ["n"], "node": ["/node"]},
    source="rcl_interfaces/ParameterEvent: new, changed and deleted parameters of a node",
)
def parameter_events_are_published() -> Any:
    with Graph("node", "watcher") as graph:
        node, watcher = graph
        told: list[ParameterEvent] = []

        def hear(event: ParameterEvent) -> None:
            if event.node == "/node":
                told.append(event)

        watcher.create_subscription(ParameterEvent, "/parameter_events", hear, 10)
        graph.until(lambda: watcher.count_publishers("/parameter_events") == 2)
        graph.spin()
        told.clear()
        node.declare_parameter("n", 1, ParameterDescriptor(dynamic_typing=True))
        node.set_parameters([Parameter("n", value=2)])
        node.set_parameters([Parameter("n")])
        graph.until(lambda: len(told) == 3)
        return {
            "new": [
                (parameter.name, parameter.value.integer_value)
                for event in told
                for parameter in event.new_parameters
            ],
            "changed": [
                (parameter.name, parameter.value.integer_value)
                for event in told
                for parameter in event.changed_parameters
            ],
            "deleted": [parameter.name for event in told for parameter in event.deleted_parameters],
            "node": sorted({event.node for event in told}),
        }


@behaviour()
def parameters_are_handled_by_an_event_handler() -> Any:
    with Graph("node", "watcher") as graph:
        node, watcher = graph
        handler = ParameterEventHandler(watcher)
        told: list[Any] = []
        handle = handler.add_parameter_callback(
            "n", "/node", lambda parameter: told.append((parameter.name, parameter.value.integer_value))
        )
        graph.until(lambda: watcher.count_publishers("/parameter_events") == 2)
        graph.spin()
        node.declare_parameters("", [("n", 1), ("m", 1)])
        node.set_parameters([Parameter("m", value=5), Parameter("n", value=2)])
        graph.until(lambda: len(told) == 2)
        handler.remove_parameter_callback(handle)
        node.set_parameters([Parameter("n", value=3)])
        graph.spin()
        return told


@behaviour(
    expected=[[True, False], 7, [7, 1.5], ["n", "x"], ["INTEGER", "DOUBLE"], "a number", True],
    source=PARAMETERS + ": the services of a node; rclpy.parameter_client.AsyncParameterClient",
)
def parameters_by_services() -> Any:
    names = {getattr(ParameterType, f"PARAMETER_{kind}"): kind for kind in ("INTEGER", "DOUBLE")}
    with Graph("node", "asker") as graph:
        node, asker = graph
        node.declare_parameter("n", 1, ParameterDescriptor(description="a number"))
        node.declare_parameter("x", 1.5)
        client = AsyncParameterClient(asker, "node")
        graph.until(client.services_are_ready)
        wanted = [Parameter("n", value=7), Parameter("x", value="text")]
        results = settled(graph.result(client.set_parameters(wanted)).results)
        values = graph.result(client.get_parameters(["n", "x"])).values
        listed = graph.result(client.list_parameters()).result.names
        kinds = graph.result(client.get_parameter_types(["n", "x"])).types
        (described,) = graph.result(client.describe_parameters(["n"])).descriptors
        together = graph.result(client.set_parameters_atomically([Parameter("n", value=8)])).result
        return [
            results,
            7 if node.get_parameter("n").value == 8 else None,
            (values[0].integer_value, values[1].double_value),
            sorted(name for name in listed if name in ("n", "x")),
            [names[kind] for kind in kinds],
            described.description,
            together.successful,
        ]


@behaviour()
def services_of_parameters_that_are_not_there() -> Any:
    with Graph("node", "asker") as graph:
        _, asker = graph
        client = AsyncParameterClient(asker, "node")
        graph.until(client.services_are_ready)
        values = graph.result(client.get_parameters(["none"])).values
        results = graph.result(client.set_parameters([Parameter("none", value=1)])).results
        kinds = graph.result(client.get_parameter_types(["none"])).types
        return len(values), settled(results), list(kinds)


@behaviour()
def the_services_of_a_node_are_there_by_default() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        graph.node("bare", start_parameter_services=False)
        return [
            sorted(name for name, _ in node.get_service_names_and_types_by_node(node_name, "/"))
            for node_name in ("node", "bare")
        ]


@behaviour()
def names_and_values_that_are_no_parameters() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        return [
            raised(node.declare_parameter, "", 1),
            raised(node.declare_parameter, "a b", 1),
            raised(node.declare_parameter, "1a", 1),
            raised(Parameter, "n", Parameter.Type.INTEGER, "text"),
            raised(Parameter, "n", value=object()),
            raised(Parameter, "n", value=[1, "a"]),
            raised(node.declare_parameters, "", [("n",)]),
            raised(node.declare_parameters, "", [(1, 2)]),
            raised(node.set_parameters, ["n"]),
        ]


@behaviour()
def a_descriptor_is_changed() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.declare_parameter("n", 5)
        before = node.describe_parameter("n")
        whole = ParameterType.PARAMETER_INTEGER
        small = ParameterDescriptor(type=whole, description="small", integer_range=[IntegerRange(to_value=6)])
        node.set_descriptor("n", small)
        after = node.describe_parameter("n")
        wrong = ParameterDescriptor(type=whole, integer_range=[IntegerRange(to_value=1)])
        return [
            (before.name, before.type, before.description),
            (after.name, after.type, after.description),
            settled(node.set_parameters([Parameter("n", value=7)])),
            raised(node.set_descriptor, "n", wrong, Parameter("n", value=9).get_parameter_value()),
            raised(node.describe_parameter, "none"),
        ]
