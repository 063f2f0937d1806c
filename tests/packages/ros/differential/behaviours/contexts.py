"""Contexts: beginning, ending, and domains."""

from __future__ import annotations

from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import Empty

from .declared import behaviour
from .graph import Graph, connect, raised

CONTEXT = "rclpy.context.Context"


@behaviour(
    expected=[False, True, "RuntimeError", False, True],
    source=CONTEXT + ".init: must only be called once; rclpy.shutdown makes a new default context possible",
)
def rclpy_begins_and_ends() -> Any:
    seen: list[Any] = [rclpy.ok()]
    rclpy.init(args=[])
    seen += [rclpy.ok(), raised(rclpy.init, args=[])]
    rclpy.shutdown()
    seen.append(rclpy.ok())
    rclpy.init(args=[])
    seen.append(rclpy.ok())
    rclpy.shutdown()
    return seen


@behaviour(
    expected=["RuntimeError", "", ""],
    source=CONTEXT + ".shutdown: must be initialized; try_shutdown: if not already shutdown",
)
def ending_what_has_not_begun() -> Any:
    first = raised(rclpy.shutdown)
    again = raised(rclpy.try_shutdown)
    rclpy.init(args=[])
    rclpy.shutdown()
    return first, again, raised(rclpy.try_shutdown)


@behaviour()
def ending_twice() -> Any:
    context = Context()
    rclpy.init(args=[], context=context)
    rclpy.shutdown(context=context)
    return raised(rclpy.shutdown, context=context), raised(rclpy.init, args=[], context=context), context.ok()


@behaviour(
    expected="NotInitializedException", source="rclpy.exceptions.NotInitializedException; rclpy.node.Node"
)
def a_node_without_a_context() -> Any:
    return raised(rclpy.create_node, "node")


@behaviour()
def a_node_after_the_end() -> Any:
    context = Context()
    rclpy.init(args=[], context=context)
    node = Node("node", context=context)
    publisher = node.create_publisher(Int32, "numbers", 1)
    client = node.create_client(Empty, "empty")
    rclpy.shutdown(context=context)
    return [
        raised(publisher.publish, Int32()),
        raised(client.call_async, Empty.Request()),
        raised(node.create_publisher, Int32, "other", 1),
        raised(node.get_name),
        raised(node.destroy_node),
        raised(node.destroy_node),
        raised(Node, "other", context=context),
        raised(node.get_clock().now),
    ]


@behaviour(expected=[True, False], source="rclpy.init: an InitContextManager that can be used to clean up")
def a_context_manager_begins_and_ends() -> Any:
    with rclpy.init(args=[]) as manager:
        inside = manager.context.ok()
    return inside, rclpy.ok()


@behaviour(
    expected=[["one", "two"], ["late"]],
    source=CONTEXT + ".on_shutdown: add a callback to be called on shutdown; called at once if it has been",
)
def callbacks_at_the_end() -> Any:
    context = Context()
    rclpy.init(args=[], context=context)
    called: list[str] = []
    first, second = (lambda: called.append("one")), (lambda: called.append("two"))

    class Keeper:
        def late(self) -> None:
            called.append("late")

    keeper = Keeper()
    keep = [_method(first), _method(second)]
    for method in keep:
        context.on_shutdown(method)
    rclpy.shutdown(context=context)
    before = list(called)
    called.clear()
    context.on_shutdown(keeper.late)
    return before, called


def _method(function: Any) -> Any:
    """A bound method, as a context keeps them."""

    class Owner:
        def act(self) -> None:
            function()

    owner = Owner()
    OWNERS.append(owner)
    return owner.act


OWNERS: list[Any] = []


@behaviour()
def a_plain_function_at_the_end() -> Any:
    context = Context()
    rclpy.init(args=[], context=context)
    called: list[int] = []
    context.on_shutdown(lambda: called.append(1))
    error = raised(rclpy.shutdown, context=context)
    return error, called


@behaviour(expected=[[7], [8], 7, 8], source="docs.ros.org, Concepts, The ROS_DOMAIN_ID")
def domains_do_not_hear_each_other() -> Any:
    with Graph("node", domain_id=7) as seven, Graph("node", domain_id=8) as eight:
        heard: dict[int, list[int]] = {7: [], 8: []}
        publishers = {}
        for number, graph in ((7, seven), (8, eight)):
            (node,) = graph
            node.create_subscription(
                Int32, "numbers", lambda message, number=number: heard[number].append(message.data), 10
            )
            publishers[number] = node.create_publisher(Int32, "numbers", 10)
            connect(graph, publishers[number])
        for number, publisher in publishers.items():
            publisher.publish(Int32(data=number))
        for graph in (seven, eight):
            graph.spin()
        return heard[7], heard[8], seven.context.get_domain_id(), eight.context.get_domain_id()


@behaviour(
    expected=["RuntimeError", "RuntimeError"],
    source=CONTEXT + ".init: domain id should not be lower than zero",
)
def domains_that_are_wrong() -> Any:
    return raised(rclpy.init, args=[], domain_id=-1), raised(Context().get_domain_id)


@behaviour()
def one_domain_in_two_contexts() -> Any:
    with Graph("one", domain_id=9) as first, Graph("two", domain_id=9) as second:
        (first_node,), (second_node,) = first, second
        seen = first.until(lambda: "two" in first_node.get_node_names())
        first.context.shutdown()
        return seen, second.context.ok(), second.until(lambda: "one" not in second_node.get_node_names())


@behaviour()
def everything_ends_with_its_node() -> Any:
    with Graph("node", "watcher") as graph:
        node, watcher = graph
        publisher = node.create_publisher(Int32, "numbers", 1)
        subscription = node.create_subscription(Int32, "numbers", print, 1)
        timer = node.create_timer(1.0, print)
        service = node.create_service(Empty, "empty", print)
        graph.until(lambda: watcher.count_publishers("numbers"))
        node.destroy_node()
        gone = graph.until(lambda: not watcher.count_publishers("numbers") + watcher.count_services("empty"))
        return [
            gone,
            raised(publisher.publish, Int32()),
            raised(subscription.get_publisher_count),
            raised(timer.reset),
            raised(lambda: service.service_name),
            raised(node.get_name),
            raised(node.create_publisher, Int32, "other", 1),
        ]


@behaviour()
def a_callback_ends_the_context() -> Any:
    rclpy.init(args=[])
    node = rclpy.create_node("node")
    ticks: list[int] = []

    def on_time() -> None:
        ticks.append(1)
        if len(ticks) == 2:
            rclpy.shutdown()

    node.create_timer(0.05, on_time)
    return raised(rclpy.spin, node), len(ticks), rclpy.ok()


@behaviour()
def spinning_after_the_end() -> Any:
    context = Context()
    rclpy.init(args=[], context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(Node("node", context=context))
    rclpy.shutdown(context=context)
    return raised(executor.spin), raised(executor.spin_once, timeout_sec=0.1)


@behaviour()
def a_node_is_a_context_manager() -> Any:
    with Graph() as graph:
        with Node("node", context=graph.context) as node:
            name = node.get_name()
        return name, raised(node.get_name)
