"""Publishers and subscriptions."""

from __future__ import annotations

import threading
import time
from typing import Any

from rclpy.serialization import deserialize_message, serialize_message
from rclpy.subscription_content_filter_options import ContentFilterOptions
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import Int32, String

from .declared import behaviour
from .graph import Graph, connect, raised

TOPICS = "docs.ros.org/en/kilted, Concepts, Topics"


@behaviour(expected=[list(range(10)), "Int32"], source=TOPICS + ": all that is published is received")
def messages_arrive_in_order() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[Int32] = []
        listener.create_subscription(Int32, "numbers", heard.append, 10)
        publisher = talker.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        for number in range(10):
            publisher.publish(Int32(data=number))
        graph.until(lambda: len(heard) == 10)
        return [message.data for message in heard], type(heard[0]).__name__


@behaviour(expected=[[1, 2], [1, 2], [1, 2]], source=TOPICS + ": zero or more subscribers to a topic")
def every_subscription_hears_every_message() -> Any:
    with Graph("talker", "one", "two") as graph:
        talker, first_node, second_node = graph
        heard: list[list[int]] = [[], [], []]
        first_node.create_subscription(Int32, "numbers", lambda message: heard[0].append(message.data), 10)
        first_node.create_subscription(Int32, "numbers", lambda message: heard[1].append(message.data), 10)
        second_node.create_subscription(Int32, "numbers", lambda message: heard[2].append(message.data), 10)
        publisher = talker.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher, 3)
        publisher.publish(Int32(data=1))
        publisher.publish(Int32(data=2))
        graph.until(lambda: all(len(numbers) == 2 for numbers in heard))
        return heard


@behaviour(expected=[[1, 2, 3], [10, 20, 30]], source=TOPICS + ": zero or more publishers of a topic")
def two_publishers_of_one_topic() -> Any:
    with Graph("one", "two", "listener") as graph:
        first_node, second_node, listener = graph
        heard: list[int] = []
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), 10)
        publishers = [node.create_publisher(Int32, "numbers", 10) for node in (first_node, second_node)]
        for publisher in publishers:
            connect(graph, publisher)
        for number in (1, 2, 3):
            publishers[0].publish(Int32(data=number))
            publishers[1].publish(Int32(data=number * 10))
        graph.until(lambda: len(heard) == 6)
        return [number for number in heard if number < 10], [number for number in heard if number >= 10]


@behaviour()
def a_node_hears_itself() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        heard: list[str] = []
        node.create_subscription(String, "words", lambda message: heard.append(message.data), 1)
        publisher = node.create_publisher(String, "words", 1)
        connect(graph, publisher)
        publisher.publish(String(data="hello"))
        graph.until(lambda: heard)
        return heard


@behaviour(expected=[2], source="docs.ros.org, About QoS: volatile, no attempt is made to persist samples")
def a_message_before_the_subscription_is_lost() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        publisher = talker.create_publisher(Int32, "numbers", 10)
        publisher.publish(Int32(data=1))
        heard: list[int] = []
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), 10)
        connect(graph, publisher)
        graph.spin()
        publisher.publish(Int32(data=2))
        graph.until(lambda: heard)
        graph.spin()
        return heard


@behaviour()
def a_destroyed_subscription_hears_nothing() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[int] = []
        subscription = listener.create_subscription(
            Int32, "numbers", lambda message: heard.append(message.data), 10
        )
        publisher = talker.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        publisher.publish(Int32(data=1))
        graph.until(lambda: heard)
        destroyed = listener.destroy_subscription(subscription)
        connect(graph, publisher, 0)
        publisher.publish(Int32(data=2))
        graph.spin()
        return destroyed, heard, listener.destroy_subscription(subscription)


@behaviour()
def a_destroyed_publisher_cannot_publish() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        subscription = listener.create_subscription(Int32, "numbers", print, 10)
        publisher = talker.create_publisher(Int32, "numbers", 10)
        counts = [graph.until(lambda: subscription.get_publisher_count() == 1)]
        talker.destroy_publisher(publisher)
        counts.append(graph.until(lambda: subscription.get_publisher_count() == 0))
        return counts, raised(publisher.publish, Int32()), raised(publisher.get_subscription_count)


@behaviour()
def a_callback_may_ask_for_the_message_info() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[Any] = []

        def hear(message: Int32, info: Any) -> None:
            stamped = info["source_timestamp"] > 0 and info["received_timestamp"] > 0
            numbers = info["publication_sequence_number"], info["reception_sequence_number"]
            heard.append((message.data, sorted(info), stamped, [number is None for number in numbers]))

        listener.create_subscription(Int32, "numbers", hear, 10)
        publisher = talker.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        publisher.publish(Int32(data=1))
        graph.until(lambda: heard)
        return heard


@behaviour()
def publications_are_counted() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[int] = []

        def hear(message: Int32, info: Any) -> None:
            heard.append(info["publication_sequence_number"])

        listener.create_subscription(Int32, "numbers", hear, 10)
        publisher = talker.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        for number in range(3):
            publisher.publish(Int32(data=number))
        graph.until(lambda: len(heard) == 3)
        return [number - heard[0] for number in heard]


@behaviour()
def a_raw_subscription_gets_bytes() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[bytes] = []
        listener.create_subscription(Int32, "numbers", heard.append, 10, raw=True)
        publisher = talker.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        publisher.publish(Int32(data=7))
        graph.until(lambda: heard)
        return type(heard[0]).__name__, heard[0].hex(), deserialize_message(heard[0], Int32).data


@behaviour()
def bytes_can_be_published() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[int] = []
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), 10)
        publisher = talker.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        publisher.publish(serialize_message(Int32(data=7)))
        graph.until(lambda: heard)
        return heard


@behaviour()
def what_is_heard_is_a_copy() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[String] = []
        for _ in range(2):
            listener.create_subscription(String, "words", heard.append, 10)
        publisher = talker.create_publisher(String, "words", 10)
        connect(graph, publisher, 2)
        said = String(data="before")
        publisher.publish(said)
        said.data = "after"
        graph.until(lambda: len(heard) == 2)
        heard[0].data = "changed by one listener"
        return heard[1].data, said.data, heard[0] is said, heard[0] is heard[1]


@behaviour(expected="RuntimeError", source="rclpy.executors.Executor.spin_once raises what a callback raises")
def an_exception_in_a_callback_leaves_the_executor() -> Any:
    with Graph("node") as graph:
        (node,) = graph

        def hear(message: Int32) -> None:
            raise RuntimeError("heard")

        node.create_subscription(Int32, "numbers", hear, 1)
        publisher = node.create_publisher(Int32, "numbers", 1)
        connect(graph, publisher)
        publisher.publish(Int32())
        return raised(graph.spin, 2.0)


@behaviour()
def a_callback_must_take_one_or_two_arguments() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        return [
            raised(node.create_subscription, Int32, "numbers", lambda: None, 1),
            raised(node.create_subscription, Int32, "numbers", lambda message, info, more: None, 1),
            raised(node.create_subscription, Int32, "numbers", lambda *arguments: None, 1),
        ]


@behaviour()
def a_callback_can_be_replaced() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        heard: list[str] = []
        subscription = node.create_subscription(Int32, "n", lambda message: heard.append("first"), 1)
        publisher = node.create_publisher(Int32, "n", 1)
        connect(graph, publisher)
        publisher.publish(Int32())
        graph.until(lambda: heard)
        subscription.callback = lambda message: heard.append("second")
        publisher.publish(Int32())
        graph.until(lambda: len(heard) == 2)
        return heard


@behaviour(
    expected=[True, 3],
    source="rclpy.wait_for_message: (True, msg) if a message was successfully received",
)
def waiting_for_a_message() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        publisher = talker.create_publisher(Int32, "numbers", 1)

        def talk() -> None:
            while not publisher.get_subscription_count():
                time.sleep(0.01)
            publisher.publish(Int32(data=3))

        thread = threading.Thread(target=talk)
        thread.start()
        found, message = wait_for_message(Int32, listener, "numbers", time_to_wait=5)
        thread.join()
        return found, message.data


@behaviour(
    expected=[False, True, True],
    source="rclpy.wait_for_message: (False, None) if message could not be obtained; time_to_wait: seconds",
)
def waiting_for_a_message_in_vain() -> Any:
    with Graph("listener") as graph:
        (listener,) = graph
        begin = time.monotonic()
        found, message = wait_for_message(Int32, listener, "numbers", time_to_wait=0.5)
        took = time.monotonic() - begin
        return found, message is None, 0.49 < took < 3.0


@behaviour()
def all_messages_are_acknowledged() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        listener.create_subscription(Int32, "numbers", lambda message: None, 10)
        publisher = talker.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        publisher.publish(Int32())
        return publisher.wait_for_all_acked()


@behaviour()
def two_types_on_one_topic_in_one_context() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        listener.create_subscription(String, "topic", print, 10)
        return raised(talker.create_publisher, Int32, "topic", 10)


@behaviour()
def two_types_on_one_topic_do_not_meet() -> Any:
    with Graph("talker") as here, Graph("listener") as there:
        heard: list[Any] = []
        (talker,), (listener,) = here, there
        listener.create_subscription(String, "topic", heard.append, 10)
        publisher = talker.create_publisher(Int32, "topic", 10)
        seen = here.until(lambda: talker.count_subscribers("topic") == 1)
        publisher.publish(Int32())
        there.spin()
        types = dict(listener.get_topic_names_and_types())["/topic"]
        return seen, heard, publisher.get_subscription_count(), sorted(types)


@behaviour(expected=[1, 2, 3], source=TOPICS + ": zero or more subscribers to a topic")
def two_contexts_hear_each_other() -> Any:
    with Graph("talker") as here, Graph("listener") as there:
        heard: list[int] = []
        (talker,), (listener,) = here, there
        subscription = listener.create_subscription(
            Int32, "n", lambda message: heard.append(message.data), 10
        )
        publisher = talker.create_publisher(Int32, "n", 10)
        connect(here, publisher)
        there.until(lambda: subscription.get_publisher_count() == 1)
        for number in (1, 2, 3):
            publisher.publish(Int32(data=number))
        there.until(lambda: len(heard) == 3)
        return heard


@behaviour()
def messages_are_filtered_by_content() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[int] = []
        subscription = listener.create_subscription(
            Int32,
            "numbers",
            lambda message: heard.append(message.data),
            10,
            content_filter_options=ContentFilterOptions("data > %0", ["2"]),
        )
        publisher = talker.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        graph.spin()
        for number in range(5):
            publisher.publish(Int32(data=number))
        graph.spin()
        return subscription.is_cft_enabled, heard


@behaviour()
def several_messages_wait_for_a_slow_listener() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[int] = []

        def hear(message: Int32) -> None:
            heard.append(message.data)
            time.sleep(0.05)

        listener.create_subscription(Int32, "numbers", hear, 3)
        publisher = talker.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        for number in range(8):
            publisher.publish(Int32(data=number))
        time.sleep(0.3)
        graph.spin(0.5)
        return heard


@behaviour()
def a_callback_may_publish() -> Any:
    with Graph("ping", "pong") as graph:
        ping, pong = graph
        heard: list[int] = []
        there = ping.create_publisher(Int32, "there", 10)
        back = pong.create_publisher(Int32, "back", 10)

        def hear(message: Int32) -> None:
            heard.append(message.data)
            if message.data < 5:
                there.publish(Int32(data=message.data + 1))

        ping.create_subscription(Int32, "back", hear, 10)
        pong.create_subscription(Int32, "there", back.publish, 10)
        connect(graph, there)
        connect(graph, back)
        there.publish(Int32(data=1))
        graph.until(lambda: len(heard) == 5)
        return heard
