"""Qualities of service: who meets whom, and what is kept for whom."""

from __future__ import annotations

import time
import warnings
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.duration import Duration, Infinite
from rclpy.parameter import Parameter
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPolicyKind,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
)
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import Int32

from .declared import behaviour
from .graph import Graph, connect, raised

ABOUT_QOS = "docs.ros.org, About Quality of Service settings"

RELIABLE = ReliabilityPolicy.RELIABLE
BEST_EFFORT = ReliabilityPolicy.BEST_EFFORT
VOLATILE = DurabilityPolicy.VOLATILE
LATCHED = DurabilityPolicy.TRANSIENT_LOCAL
AUTOMATIC = LivelinessPolicy.AUTOMATIC
BY_TOPIC = LivelinessPolicy.MANUAL_BY_TOPIC


def profile(depth: int = 10, **policies: Any) -> QoSProfile:
    """A profile that keeps the last messages."""
    return QoSProfile(depth=depth, **policies)


def meeting(offered: QoSProfile, requested: QoSProfile) -> tuple[bool, int]:
    """Whether a message arrives, and how many subscriptions the publisher has."""
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[Any] = []
        listener.create_subscription(Int32, "numbers", heard.append, requested)
        publisher = talker.create_publisher(Int32, "numbers", offered)
        graph.until(publisher.get_subscription_count, 0.3)
        publisher.publish(Int32())
        graph.until(lambda: heard, 0.3)
        return bool(heard), publisher.get_subscription_count()


def late(offered: QoSProfile, requested: QoSProfile, count: int = 5) -> list[int]:
    """What a subscription hears of messages that were published before it was there."""
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        publisher = talker.create_publisher(Int32, "numbers", offered)
        for number in range(count):
            publisher.publish(Int32(data=number))
        heard: list[int] = []
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), requested)
        connect(graph, publisher)
        graph.spin(0.5)
        return heard


@behaviour(
    expected=[[True, 1], [True, 1], [False, 0], [True, 1]],
    source=ABOUT_QOS + ", compatibility of reliability",
)
def reliability_matches() -> Any:
    policies = [
        (BEST_EFFORT, BEST_EFFORT),
        (RELIABLE, BEST_EFFORT),
        (BEST_EFFORT, RELIABLE),
        (RELIABLE, RELIABLE),
    ]
    return [meeting(profile(reliability=first), profile(reliability=second)) for first, second in policies]


@behaviour(
    expected=[[True, 1], [False, 0], [True, 1], [True, 1]],
    source=ABOUT_QOS + ", compatibility of durability",
)
def durability_matches() -> Any:
    policies = [(VOLATILE, VOLATILE), (VOLATILE, LATCHED), (LATCHED, VOLATILE), (LATCHED, LATCHED)]
    return [meeting(profile(durability=first), profile(durability=second)) for first, second in policies]


@behaviour(
    expected=[[True, 1], [False, 0], [True, 1], [True, 1], [False, 0]],
    source=ABOUT_QOS + ", compatibility of deadline: x with x, with larger or default, not with smaller",
)
def deadlines_match() -> Any:
    short, long = Duration(seconds=1), Duration(seconds=2)
    pairs = [(Infinite, Infinite), (Infinite, short), (short, Infinite), (short, long), (long, short)]
    return [meeting(profile(deadline=first), profile(deadline=second)) for first, second in pairs]


@behaviour(
    expected=[[True, 1], [False, 0], [True, 1], [True, 1]],
    source=ABOUT_QOS + ", compatibility of liveliness",
)
def liveliness_matches() -> Any:
    policies = [(AUTOMATIC, AUTOMATIC), (AUTOMATIC, BY_TOPIC), (BY_TOPIC, AUTOMATIC), (BY_TOPIC, BY_TOPIC)]
    return [meeting(profile(liveliness=first), profile(liveliness=second)) for first, second in policies]


@behaviour(
    expected=[[False, 0], [True, 1], [False, 0], [True, 1]],
    source=ABOUT_QOS + ", compatibility of lease duration: as that of deadline",
)
def lease_durations_match() -> Any:
    short, long = Duration(seconds=1), Duration(seconds=2)
    pairs = [(Infinite, short), (short, Infinite), (long, short), (short, long)]
    return [
        meeting(profile(liveliness_lease_duration=first), profile(liveliness_lease_duration=second))
        for first, second in pairs
    ]


@behaviour()
def profiles_are_checked_for_compatibility() -> Any:
    second = Duration(seconds=1)
    pairs = [
        (profile(), profile()),
        (profile(reliability=BEST_EFFORT), profile(reliability=RELIABLE)),
        (profile(durability=VOLATILE), profile(durability=LATCHED)),
        (profile(), profile(deadline=second)),
        (profile(liveliness=AUTOMATIC), profile(liveliness=BY_TOPIC)),
        (profile(), profile(liveliness_lease_duration=second)),
        (profile(reliability=ReliabilityPolicy.SYSTEM_DEFAULT), profile(reliability=RELIABLE)),
        (profile(reliability=ReliabilityPolicy.BEST_AVAILABLE), profile(reliability=RELIABLE)),
    ]
    return [
        (str(answer[0]), answer[1]) for answer in (qos_check_compatible(left, right) for left, right in pairs)
    ]


@behaviour(expected=[7, 8, 9], source=ABOUT_QOS + ": keep last, only store up to N samples")
def a_subscription_keeps_the_last() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[int] = []
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), 3)
        publisher = talker.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        for number in range(10):
            publisher.publish(Int32(data=number))
        time.sleep(0.3)
        graph.spin()
        return heard


@behaviour(expected=list(range(50)), source=ABOUT_QOS + ": keep all, store all samples")
def a_subscription_keeps_all() -> Any:
    everything = QoSProfile(history=HistoryPolicy.KEEP_ALL)
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[int] = []
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), everything)
        publisher = talker.create_publisher(Int32, "numbers", everything)
        connect(graph, publisher)
        for number in range(50):
            publisher.publish(Int32(data=number))
        time.sleep(0.3)
        graph.spin()
        return heard


@behaviour(
    expected=[3, 4],
    source=ABOUT_QOS + ": transient local, the publisher persists samples for late-joining subscriptions",
)
def a_late_subscription_hears_what_was_kept() -> Any:
    return late(profile(2, durability=LATCHED), profile(10, durability=LATCHED))


@behaviour(expected=[4], source=ABOUT_QOS + ": keep last, only store up to N samples")
def a_late_subscription_keeps_less_than_is_offered() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        publisher = talker.create_publisher(Int32, "numbers", profile(5, durability=LATCHED))
        for number in range(5):
            publisher.publish(Int32(data=number))
        heard: list[int] = []
        latched = profile(1, durability=LATCHED)
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), latched)
        time.sleep(0.3)
        graph.spin()
        return heard


@behaviour(expected=[], source=ABOUT_QOS + ": volatile and volatile, new messages only")
def a_late_volatile_subscription_hears_nothing() -> Any:
    return late(profile(5, durability=LATCHED), profile(5, durability=VOLATILE))


@behaviour(expected=list(range(5)), source=ABOUT_QOS + ": keep all, store all samples")
def a_publisher_keeps_all_for_late_subscriptions() -> Any:
    everything = QoSProfile(history=HistoryPolicy.KEEP_ALL, durability=LATCHED)
    return late(everything, profile(10, durability=LATCHED))


@behaviour()
def several_late_subscriptions() -> Any:
    latched = profile(2, durability=LATCHED)
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        publisher = talker.create_publisher(Int32, "numbers", latched)
        heard: list[list[int]] = [[], [], []]
        for count, numbers in enumerate(heard, 1):
            publisher.publish(Int32(data=count))
            listener.create_subscription(
                Int32, "numbers", lambda message, numbers=numbers: numbers.append(message.data), latched
            )
            connect(graph, publisher, count)
            graph.spin()
        return heard


@behaviour()
def what_is_kept_ends_with_its_publisher() -> Any:
    latched = profile(2, durability=LATCHED)
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        publisher = talker.create_publisher(Int32, "numbers", latched)
        publisher.publish(Int32(data=1))
        talker.destroy_publisher(publisher)
        heard: list[int] = []
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), latched)
        graph.spin(0.5)
        return heard


@behaviour(
    expected=[[0, 1], []],
    source=ABOUT_QOS + ": lifespan, messages that are older than it are dropped",
)
def messages_end_with_their_lifespan() -> Any:
    heard = []
    for wait in (0.0, 0.8):
        with Graph("talker", "listener") as graph:
            talker, listener = graph
            short = profile(5, durability=LATCHED, lifespan=Duration(seconds=0.4))
            publisher = talker.create_publisher(Int32, "numbers", short)
            for number in range(2):
                publisher.publish(Int32(data=number))
            time.sleep(wait)
            numbers: list[int] = []
            listener.create_subscription(
                Int32,
                "numbers",
                lambda message, numbers=numbers: numbers.append(message.data),
                profile(5, durability=LATCHED),
            )
            graph.spin()
            heard.append(numbers)
    return heard


@behaviour()
def unread_messages_end_with_their_lifespan() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[int] = []
        short = profile(5, lifespan=Duration(seconds=0.3))
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), short)
        publisher = talker.create_publisher(Int32, "numbers", short)
        connect(graph, publisher)
        publisher.publish(Int32(data=1))
        time.sleep(0.8)
        publisher.publish(Int32(data=2))
        graph.spin()
        return heard


def _policies(chosen: QoSProfile) -> list[Any]:
    return [
        chosen.history.name,
        chosen.depth,
        chosen.reliability.name,
        chosen.durability.name,
        chosen.liveliness.name,
        str(chosen.deadline),
        str(chosen.lifespan),
        str(chosen.liveliness_lease_duration),
    ]


@behaviour()
def presets() -> Any:
    return {preset.name: _policies(preset.value) for preset in QoSPresetProfiles}


@behaviour()
def what_a_publisher_and_a_subscription_have() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.create_publisher(Int32, "numbers", 7)
        node.create_subscription(
            Int32, "numbers", print, profile(3, durability=LATCHED, reliability=BEST_EFFORT)
        )
        graph.until(lambda: node.count_publishers("numbers") and node.count_subscribers("numbers"))
        (offered,) = node.get_publishers_info_by_topic("/numbers")
        (requested,) = node.get_subscriptions_info_by_topic("/numbers")
        return [_policies(info.qos_profile)[2:] for info in (offered, requested)]


@behaviour(
    expected=[["RELIABLE", "TRANSIENT_LOCAL"], ["BEST_EFFORT", "VOLATILE"]],
    source=ABOUT_QOS + ": best available, the highest level of service that matches all there are",
)
def the_best_available() -> Any:
    found = []
    best = profile(reliability=ReliabilityPolicy.BEST_AVAILABLE, durability=DurabilityPolicy.BEST_AVAILABLE)
    for offered in (
        profile(reliability=RELIABLE, durability=LATCHED),
        profile(reliability=BEST_EFFORT, durability=VOLATILE),
    ):
        with Graph("node") as graph:
            (node,) = graph
            node.create_publisher(Int32, "numbers", offered)
            graph.until(lambda node=node: node.count_publishers("numbers"))
            node.create_subscription(Int32, "numbers", print, best)
            graph.until(lambda node=node: node.count_subscribers("numbers"))
            (info,) = node.get_subscriptions_info_by_topic("/numbers")
            found.append([info.qos_profile.reliability.name, info.qos_profile.durability.name])
    return found


@behaviour()
def profiles_that_are_wrong() -> Any:
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        zero = QoSProfile(depth=0)
    return [
        raised(QoSProfile),
        raised(QoSProfile, history=HistoryPolicy.KEEP_LAST),
        raised(QoSProfile, depth=1.5),
        raised(QoSProfile, depth=1, reliability=9),
        raised(QoSProfile, depth=1, deadline=1),
        raised(QoSProfile, depth=1, reliability="reliable"),
        len(warned),
        zero.depth,
        profile() == profile(),
        profile() == profile(3),
    ]


@behaviour(
    expected=["ValueError", "TypeError", "", ""],
    source="rclpy.node.Node: a depth is at least zero; a profile or a number",
)
def a_depth_instead_of_a_profile() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        return [
            raised(node.create_publisher, Int32, "topic", depth)
            for depth in (-1, "10", 1, QoSProfile(depth=1))
        ]


@behaviour()
def names_of_policies() -> Any:
    return [
        ReliabilityPolicy.short_keys(),
        DurabilityPolicy.short_keys(),
        ReliabilityPolicy.get_from_short_key("best_effort"),
        DurabilityPolicy.TRANSIENT_LOCAL.short_key,
        QoSPolicyKind(2).name,
    ]


@behaviour()
def a_profile_is_overridden_by_parameters() -> Any:
    overrides = [
        Parameter("qos_overrides./numbers.publisher.depth", value=3),
        Parameter("qos_overrides./numbers.publisher.reliability", value="best_effort"),
    ]
    with Graph("node", parameter_overrides=overrides) as graph:
        (node,) = graph
        node.create_publisher(
            Int32, "numbers", 10, qos_overriding_options=QoSOverridingOptions.with_default_policies()
        )
        graph.until(lambda: node.count_publishers("numbers"))
        (info,) = node.get_publishers_info_by_topic("/numbers")
        declared = {
            name: parameter.value
            for name, parameter in node.get_parameters_by_prefix("qos_overrides./numbers").items()
        }
        return info.qos_profile.reliability.name, declared


@behaviour()
def overriding_a_profile_can_be_refused() -> Any:
    def refuse(chosen: QoSProfile) -> Any:
        return SetParametersResult(successful=chosen.depth == 10, reason="depth")

    options = QoSOverridingOptions.with_default_policies(callback=refuse)
    with Graph(
        "node", parameter_overrides=[Parameter("qos_overrides./two.publisher.depth", value=3)]
    ) as graph:
        (node,) = graph
        return [
            raised(node.create_publisher, Int32, topic, 10, qos_overriding_options=options)
            for topic in ("one", "two")
        ]
