"""Events of publishers and subscriptions."""

from __future__ import annotations

from typing import Any

from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32

from .declared import behaviour
from .graph import Graph, connect

ABOUT_QOS = "docs.ros.org, About Quality of Service settings, QoS events"

RELIABLE = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)


def _incompatible(offered: QoSProfile, requested: QoSProfile) -> Any:
    """What both sides are told: count, and change of the count, and the kind of policy."""
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        told: dict[str, list[Any]] = {"publisher": [], "subscription": []}

        def tell(side: str) -> Any:
            return lambda event: told[side].append(
                (event.total_count, event.total_count_change, int(event.last_policy_kind))
            )

        listener.create_subscription(
            Int32,
            "numbers",
            print,
            requested,
            event_callbacks=SubscriptionEventCallbacks(incompatible_qos=tell("subscription")),
        )
        talker.create_publisher(
            Int32,
            "numbers",
            offered,
            event_callbacks=PublisherEventCallbacks(incompatible_qos=tell("publisher")),
        )
        graph.until(lambda: all(told.values()), 2.0)
        graph.spin()
        return told


@behaviour(
    expected={"publisher": [[1, 1, 16]], "subscription": [[1, 1, 16]]},
    source=ABOUT_QOS + ": incompatible QoS; rclpy.qos.QoSPolicyKind.RELIABILITY is 16",
)
def reliability_that_does_not_match_is_told() -> Any:
    return _incompatible(BEST_EFFORT, RELIABLE)


@behaviour(
    expected={"publisher": [[1, 1, 2]], "subscription": [[1, 1, 2]]},
    source=ABOUT_QOS + ": incompatible QoS; rclpy.qos.QoSPolicyKind.DURABILITY is 2",
)
def durability_that_does_not_match_is_told() -> Any:
    return _incompatible(RELIABLE, QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))


@behaviour(
    expected={"publisher": [[1, 1, 4]], "subscription": [[1, 1, 4]]},
    source=ABOUT_QOS + ": incompatible QoS; rclpy.qos.QoSPolicyKind.DEADLINE is 4",
)
def a_deadline_that_does_not_match_is_told() -> Any:
    return _incompatible(RELIABLE, QoSProfile(depth=1, deadline=Duration(seconds=1)))


@behaviour(
    expected={"publisher": [], "subscription": []}, source=ABOUT_QOS + ": incompatible QoS, only if it is so"
)
def qualities_that_match_are_not_told() -> Any:
    return _incompatible(RELIABLE, BEST_EFFORT)


def _counts(event: Any) -> tuple[int, int, int, int]:
    return event.total_count, event.total_count_change, event.current_count, event.current_count_change


@behaviour(
    expected=[[1, 1, 1, 1], [2, 1, 2, 1], [2, 0, 1, -1]],
    source="docs.ros.org, About QoS, matched events: number of entities that match, and its change",
)
def a_publisher_is_told_who_subscribes() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        told: list[Any] = []
        talker.create_publisher(
            Int32,
            "numbers",
            10,
            event_callbacks=PublisherEventCallbacks(matched=lambda event: told.append(_counts(event))),
        )
        subscriptions = []
        for count in (1, 2):
            subscriptions.append(listener.create_subscription(Int32, "numbers", print, 10))
            graph.until(lambda count=count: len(told) == count)
        listener.destroy_subscription(subscriptions[0])
        graph.until(lambda: len(told) == 3)
        return told


@behaviour(
    expected=[[1, 1, 1, 1], [1, 0, 0, -1]],
    source="docs.ros.org, About QoS, matched events: number of entities that match, and its change",
)
def a_subscription_is_told_who_publishes() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        told: list[Any] = []
        listener.create_subscription(
            Int32,
            "numbers",
            print,
            10,
            event_callbacks=SubscriptionEventCallbacks(matched=lambda event: told.append(_counts(event))),
        )
        publisher = talker.create_publisher(Int32, "numbers", 10)
        graph.until(lambda: len(told) == 1)
        talker.destroy_publisher(publisher)
        graph.until(lambda: len(told) == 2)
        return told


@behaviour(
    expected={"publisher": [1, 2], "subscription": [1, 2]},
    source=ABOUT_QOS + ": deadline missed, on both sides",
)
def missed_deadlines_are_told() -> Any:
    often = QoSProfile(depth=10, deadline=Duration(seconds=0.4))
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        told: dict[str, list[int]] = {"publisher": [], "subscription": []}
        listener.create_subscription(
            Int32,
            "numbers",
            lambda message: None,
            often,
            event_callbacks=SubscriptionEventCallbacks(
                deadline=lambda event: told["subscription"].append(event.total_count)
            ),
        )
        publisher = talker.create_publisher(
            Int32,
            "numbers",
            often,
            event_callbacks=PublisherEventCallbacks(
                deadline=lambda event: told["publisher"].append(event.total_count)
            ),
        )
        connect(graph, publisher)
        for _ in range(5):
            publisher.publish(Int32())
            graph.spin(0.1)
        graph.spin(0.9)
        return told


@behaviour()
def deadlines_that_are_kept_are_not_told() -> Any:
    often = QoSProfile(depth=10, deadline=Duration(seconds=1.0))
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        told: list[int] = []
        listener.create_subscription(
            Int32,
            "numbers",
            lambda message: None,
            often,
            event_callbacks=SubscriptionEventCallbacks(deadline=lambda event: told.append(event.total_count)),
        )
        publisher = talker.create_publisher(Int32, "numbers", often)
        connect(graph, publisher)
        for _ in range(8):
            publisher.publish(Int32())
            graph.spin(0.2)
        return told


def _alive(event: Any) -> tuple[int, int, int, int]:
    return event.alive_count, event.not_alive_count, event.alive_count_change, event.not_alive_count_change


@behaviour()
def a_publisher_that_says_nothing_is_not_alive() -> Any:
    lively = QoSProfile(
        depth=10,
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
        liveliness_lease_duration=Duration(seconds=0.4),
    )
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        told: list[Any] = []
        lost: list[int] = []
        listener.create_subscription(
            Int32,
            "numbers",
            lambda message: None,
            lively,
            event_callbacks=SubscriptionEventCallbacks(liveliness=lambda event: told.append(_alive(event))),
        )
        publisher = talker.create_publisher(
            Int32,
            "numbers",
            lively,
            event_callbacks=PublisherEventCallbacks(liveliness=lambda event: lost.append(event.total_count)),
        )
        connect(graph, publisher)
        publisher.assert_liveliness()
        graph.until(lambda: len(told) == 1)
        graph.spin(1.0)
        publisher.publish(Int32())
        graph.until(lambda: len(told) == 3)
        return told, lost


@behaviour()
def a_publisher_that_asserts_itself_stays_alive() -> Any:
    lively = QoSProfile(
        depth=10,
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
        liveliness_lease_duration=Duration(seconds=1.0),
    )
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        told: list[Any] = []
        listener.create_subscription(
            Int32,
            "numbers",
            lambda message: None,
            lively,
            event_callbacks=SubscriptionEventCallbacks(liveliness=lambda event: told.append(_alive(event))),
        )
        publisher = talker.create_publisher(Int32, "numbers", lively)
        connect(graph, publisher)
        for _ in range(8):
            publisher.assert_liveliness()
            graph.spin(0.2)
        return told


@behaviour()
def an_automatic_publisher_is_alive_until_it_ends() -> Any:
    lively = QoSProfile(depth=10, liveliness_lease_duration=Duration(seconds=1.0))
    found = []
    for in_two_contexts in (False, True):
        with Graph("listener") as here, Graph() as there:
            (listener,) = here
            told: list[Any] = []
            callbacks = SubscriptionEventCallbacks(
                liveliness=lambda event, told=told: told.append(_alive(event))
            )
            listener.create_subscription(
                Int32, "numbers", lambda message: None, lively, event_callbacks=callbacks
            )
            talker = (there if in_two_contexts else here).node("talker")
            publisher = talker.create_publisher(Int32, "numbers", lively)
            connect(here, publisher)
            here.spin(1.5)
            talker.destroy_publisher(publisher)
            here.until(lambda told=told: len(told) == 2, 1.0)
            found.append(told)
    return found


@behaviour()
def handlers_of_the_events_asked_for() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        found = {}
        for name in (
            "deadline",
            "incompatible_qos",
            "liveliness",
            "message_lost",
            "incompatible_type",
            "matched",
        ):
            callbacks = SubscriptionEventCallbacks(**{name: print})
            found[name] = len(
                node.create_subscription(Int32, "n", print, 1, event_callbacks=callbacks).event_handlers
            )
        for name in ("deadline", "incompatible_qos", "liveliness", "incompatible_type", "matched"):
            made = node.create_publisher(
                Int32, "n", 1, event_callbacks=PublisherEventCallbacks(**{name: print})
            )
            found[f"publisher's {name}"] = len(made.event_handlers)
        return found


@behaviour()
def event_handlers_by_default() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        none = SubscriptionEventCallbacks(use_default_callbacks=False)
        return [
            len(node.create_subscription(Int32, "n", print, 1).event_handlers),
            len(node.create_subscription(Int32, "n", print, 1, event_callbacks=none).event_handlers),
            len(node.create_publisher(Int32, "n", 1).event_handlers),
        ]
