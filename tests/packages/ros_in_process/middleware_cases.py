"""The middleware: run by ``test_ros2_simulation.py`` over the simulation.

What is expected here is what real ROS does; the differential tests hold both against each other.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest
import rclpy
from geometry_msgs.msg import PointStamped
from lifecycle_msgs.msg import TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.msg import Log
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, Int32, String, UInt8
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci

from ros_in_process.machine.scheduler import SCHEDULER
from ros_in_process.machine.schedules import RandomOrder


class Pair:
    """Two nodes that one executor spins."""

    def __init__(self) -> None:
        self.one, self.other = rclpy.create_node("one"), rclpy.create_node("other")
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.one)
        self._executor.add_node(self.other)

    def add(self, node: Node) -> None:
        self._executor.add_node(node)

    def spin(self, seconds: float = 0.1) -> None:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self._executor.spin_once(timeout_sec=left)

    def result(self, future: Any) -> Any:
        self._executor.spin_until_future_complete(future, timeout_sec=5.0)
        return future.result()

    def hear(self, kind: type, topic: str, qos: Any = 10, **options: Any) -> list[Any]:
        heard: list[Any] = []
        self.other.create_subscription(kind, topic, heard.append, qos, **options)
        return heard


@pytest.fixture
def pair() -> Iterator[Pair]:
    with rclpy.init():
        yield Pair()


def test_a_subscription_keeps_the_last_messages_of_its_depth(pair: Pair) -> None:
    heard = pair.hear(Int32, "numbers", 3)
    publisher = pair.one.create_publisher(Int32, "numbers", 10)
    for number in range(10):
        publisher.publish(Int32(data=number))
    pair.spin()
    assert [message.data for message in heard] == [7, 8, 9]


def test_a_message_is_nobody_elses_object(pair: Pair) -> None:
    first, second = pair.hear(JointState, "joints"), pair.hear(JointState, "joints")
    message = JointState(name=["a"], position=[1.0])
    pair.one.create_publisher(JointState, "joints", 10).publish(message)
    message.position[0], message.name[0] = 2.0, "b"
    pair.spin()
    first[0].position[0] = 3.0
    assert (second[0].name, list(second[0].position)) == (["a"], [1.0])


def test_late_joiners_hear_what_is_latched_and_has_not_expired(pair: Pair) -> None:
    latched = QoSProfile(depth=2, durability=DurabilityPolicy.TRANSIENT_LOCAL, lifespan=Duration(seconds=1))
    publisher = pair.one.create_publisher(Int32, "latched", latched)
    for number in range(3):
        publisher.publish(Int32(data=number))
        time.sleep(0.4)
    heard = pair.hear(Int32, "latched", QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    pair.spin()
    assert [message.data for message in heard] == [1, 2]
    time.sleep(1.0)
    assert pair.hear(Int32, "latched", latched) == []


def test_incompatible_offers_are_reported_to_both_ends(pair: Pair) -> None:
    told: list[Any] = []
    pair.other.create_subscription(
        Int32, "topic", told.append, QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE),
        event_callbacks=SubscriptionEventCallbacks(incompatible_qos=told.append),
    )  # fmt: skip
    publisher = pair.one.create_publisher(
        Int32, "topic", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT),
        event_callbacks=PublisherEventCallbacks(incompatible_qos=told.append),
    )  # fmt: skip
    publisher.publish(Int32())
    pair.spin()
    assert [(event.total_count, event.last_policy_kind.name) for event in told] == [
        (1, "RMW_QOS_POLICY_RELIABILITY")
    ] * 2
    assert publisher.get_subscription_count() == 0


def test_missed_deadlines_and_matches_are_reported(pair: Pair) -> None:
    missed: list[int] = []
    matched: list[tuple[int, int]] = []
    qos = QoSProfile(depth=1, deadline=Duration(seconds=0.2))
    pair.other.create_subscription(
        Int32, "topic", lambda message: None, qos,
        event_callbacks=SubscriptionEventCallbacks(
            deadline=lambda event: missed.append(event.total_count),
            matched=lambda event: matched.append((event.current_count, event.current_count_change)),
        ),
    )  # fmt: skip
    publisher = pair.one.create_publisher(Int32, "topic", qos)
    publisher.publish(Int32())
    pair.spin(0.5)
    assert missed == [1, 2]
    pair.one.destroy_publisher(publisher)
    pair.spin()
    assert matched == [(1, 1), (0, -1)]


def test_a_publisher_that_does_not_say_that_it_lives_is_dead(pair: Pair) -> None:
    changes: list[tuple[int, int]] = []
    lost: list[int] = []
    qos = QoSProfile(
        depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC, liveliness_lease_duration=Duration(seconds=0.5)
    )
    pair.other.create_subscription(
        Int32, "topic", lambda message: None, qos,
        event_callbacks=SubscriptionEventCallbacks(
            liveliness=lambda event: changes.append((event.alive_count, event.not_alive_count))
        ),
    )  # fmt: skip
    publisher = pair.one.create_publisher(
        Int32, "topic", qos,
        event_callbacks=PublisherEventCallbacks(liveliness=lambda event: lost.append(event.total_count)),
    )  # fmt: skip
    publisher.assert_liveliness()
    pair.spin(0.3)
    publisher.publish(Int32())
    pair.spin(1.0)
    assert changes == [(1, 0), (0, 1)]
    assert lost == [1]


@pytest.mark.parametrize(
    ("kind", "value", "error"),
    [
        (Int32, "1", SystemError), (Int32, 1.5, SystemError), (Int32, None, SystemError),
        (UInt8, -1, SystemError), (Int32, 2**70, SystemError), (String, 1, TypeError),
        (String, None, TypeError),
    ],
)  # fmt: skip
def test_wrong_values_raise_at_publish(pair: Pair, kind: Any, value: Any, error: type[Exception]) -> None:
    publisher = pair.one.create_publisher(kind, "topic", 1)
    message = kind()
    message.data = value
    with pytest.raises(error):
        publisher.publish(message)


@pytest.mark.parametrize(
    ("kind", "value", "heard"),
    [(Int32, 2**33 + 5, 5), (UInt8, 300, 44), (Bool, 1, False), (Float64, 1, 5e-324)],
)
def test_other_wrong_values_arrive_as_something_else(pair: Pair, kind: Any, value: Any, heard: Any) -> None:
    messages = pair.hear(kind, "topic")
    message = kind()
    message.data = value
    pair.one.create_publisher(kind, "topic", 1).publish(message)
    pair.spin()
    assert messages[0].data == heard


def test_parts_of_wrong_types_raise(pair: Pair) -> None:
    publisher = pair.one.create_publisher(PointStamped, "topic", 1)
    with pytest.raises(AttributeError, match="'NoneType' object has no attribute 'x'"):
        publisher.publish(PointStamped(point=None))
    with pytest.raises(TypeError, match="Expected"):
        publisher.publish(Int32())


def test_services_answer_and_are_found(pair: Pair) -> None:
    def answer(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        response.success = request.data
        return response

    client = pair.one.create_client(SetBool, "switch")
    assert not client.wait_for_service(timeout_sec=0.5)
    service = pair.other.create_service(SetBool, "switch", answer)
    assert client.wait_for_service(timeout_sec=0.5)
    assert pair.result(client.call_async(SetBool.Request(data=True))).success
    pair.other.destroy_service(service)
    assert not client.service_is_ready()


def test_an_action_gives_feedback_and_a_result(pair: Pair) -> None:
    def execute(goal: Any) -> Fibonacci.Result:
        for number in range(goal.request.order):
            goal.publish_feedback(Fibonacci.Feedback(sequence=[number]))
        goal.succeed()
        return Fibonacci.Result(sequence=[1, 1, 2])

    feedback: list[int] = []
    server = ActionServer(pair.other, Fibonacci, "count", execute)
    client = ActionClient(pair.one, Fibonacci, "count")
    assert client.wait_for_server(timeout_sec=1.0)
    goal = pair.result(
        client.send_goal_async(
            Fibonacci.Goal(order=3),
            feedback_callback=lambda message: feedback.append(message.feedback.sequence[0]),
        )
    )
    result = pair.result(goal.get_result_async())
    pair.spin()
    assert (goal.accepted, result.status, list(result.result.sequence)) == (True, 4, [1, 1, 2])
    assert feedback == [0, 1, 2]
    late = goal.get_result_async()
    assert pair.result(late).status == 4
    pair.spin(30.0)
    assert pair.result(goal.get_result_async()).status == 0, "its result has expired"
    server.destroy()


def test_an_action_can_be_cancelled(pair: Pair) -> None:
    async def execute(goal: Any) -> Fibonacci.Result:
        while not goal.is_cancel_requested:
            waiting = rclpy.task.Future()
            timer = pair.other.create_timer(0.1, partial(waiting.set_result, None))
            await waiting
            timer.cancel()
        goal.canceled()
        return Fibonacci.Result()

    server = ActionServer(
        pair.other, Fibonacci, "count", execute, cancel_callback=lambda goal: CancelResponse.ACCEPT
    )
    client = ActionClient(pair.one, Fibonacci, "count")
    goal = pair.result(client.send_goal_async(Fibonacci.Goal(order=3)))
    result = goal.get_result_async()
    pair.spin(0.5)
    answer = pair.result(goal.cancel_goal_async())
    assert (answer.return_code, len(answer.goals_canceling)) == (0, 1)
    assert pair.result(result).status == 5
    assert pair.result(goal.cancel_goal_async()).return_code == 3, "it has ended"
    server.destroy()


def test_parameters_are_set_from_outside(pair: Pair) -> None:
    pair.other.declare_parameter("speed", 1.0)
    events = pair.hear(rclpy.node.ParameterEvent, "/parameter_events")
    client = AsyncParameterClient(pair.one, "other")
    assert client.wait_for_services(timeout_sec=1.0)
    answer = pair.result(
        client.set_parameters([Parameter("speed", value=2.0), Parameter("unknown", value=1)])
    )
    assert [result.successful for result in answer.results] == [True, False]
    assert pair.other.get_parameter("speed").value == 2.0
    pair.spin()
    assert [event.changed_parameters[0].name for event in events if event.changed_parameters] == ["speed"]


def test_a_lifecycle_node_is_led_by_its_services(pair: Pair) -> None:
    node = LifecycleNode("driver")
    pair.add(node)
    events = pair.hear(TransitionEvent, "/driver/transition_event")
    change = pair.one.create_client(ChangeState, "/driver/change_state")
    state = pair.one.create_client(GetState, "/driver/get_state")
    publisher = node.create_lifecycle_publisher(Int32, "values", 1)
    heard = pair.hear(Int32, "values")
    for transition, expected in ((1, "inactive"), (3, "active"), (4, "inactive"), (2, "unconfigured")):
        request = ChangeState.Request()
        request.transition.id = transition
        assert pair.result(change.call_async(request)).success
        assert pair.result(state.call_async(GetState.Request())).current_state.label == expected
        publisher.publish(Int32(data=transition))
    request.transition.id = 3
    assert not pair.result(change.call_async(request)).success
    pair.spin()
    assert [event.goal_state.label for event in events][:3] == ["configuring", "inactive", "activating"]
    assert [message.data for message in heard] == [3]


def test_names_are_expanded_and_remapped() -> None:
    arguments = [
        "--ros-args",
        "-r",
        "__ns:=/cell",
        "-r",
        "a:=b",
        "-r",
        "arm:c:=/d",
        "-r",
        "rosservice://e:=f",
    ]
    with rclpy.init(args=arguments):
        arm, other = rclpy.create_node("arm"), rclpy.create_node("other")
        names: list[Callable[[Node], str]] = [
            lambda node: node.create_publisher(Int32, "a", 1).topic_name,
            lambda node: node.resolve_topic_name("c"),
            lambda node: node.resolve_topic_name("~/a"),
            lambda node: node.resolve_service_name("e"),
            lambda node: node.resolve_topic_name("e"),
        ]
        assert [name(arm) for name in names] == ["/cell/b", "/d", "/cell/arm/a", "/cell/f", "/cell/e"]
        assert [name(other) for name in names] == [
            "/cell/b",
            "/cell/c",
            "/cell/other/a",
            "/cell/f",
            "/cell/e",
        ]


def test_domains_do_not_hear_each_other() -> None:
    first, second = Context(), Context()
    rclpy.init(context=first, domain_id=1)
    rclpy.init(context=second, domain_id=2)
    first_node, second_node = (
        rclpy.create_node("one", context=first),
        rclpy.create_node("other", context=second),
    )
    publisher = first_node.create_publisher(Int32, "topic", 1)
    second_node.create_subscription(Int32, "topic", print, 1)
    assert publisher.get_subscription_count() == second_node.count_publishers("/topic") == 0
    assert second_node.get_node_names() == ["other"]
    for context in (first, second):
        rclpy.shutdown(context=context)


def test_what_nodes_log_is_on_rosout_and_the_standard_error(
    pair: Pair, capfd: pytest.CaptureFixture[str]
) -> None:
    heard = pair.hear(Log, "/rosout")
    pair.one.get_logger().warning("careful")
    pair.one.get_logger().debug("not told")
    pair.spin()
    assert [(message.name, message.msg) for message in heard] == [("one", "careful")]
    assert "[WARN]" in capfd.readouterr().err


def test_endpoints_report_their_quality_of_service(pair: Pair) -> None:
    pair.one.create_publisher(
        String, "topic", QoSProfile(depth=7, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    )
    info = pair.other.get_publishers_info_by_topic("/topic")[0]
    assert (info.node_name, info.topic_type) == ("one", "std_msgs/msg/String")
    assert info.qos_profile.durability is DurabilityPolicy.TRANSIENT_LOCAL
    assert str(info.topic_type_hash).startswith("RIHS01_df668c74")


def test_messages_survive_as_bytes(pair: Pair) -> None:
    message = JointState(name=["a", "bc"], position=[1.0, 2.0])
    message.header.frame_id = "é"
    assert deserialize_message(serialize_message(message), JointState) == message
    heard = pair.hear(Int32, "raw", raw=True)
    pair.one.create_publisher(Int32, "raw", 1).publish(serialize_message(Int32(data=5)))
    pair.spin()
    assert heard == [b"\x00\x01\x00\x00\x05\x00\x00\x00"]


@pytest.mark.parametrize("seed", range(8))
def test_in_each_order_a_trigger_of_a_guard_condition_has_its_callback_run_once(
    pair: Pair, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(SCHEDULER, "schedule", RandomOrder(seed))
    monkeypatch.setattr(SCHEDULER, "is_preemptive", True)
    called: list[str] = []
    guards = [pair.one.create_guard_condition(partial(called.append, name)) for name in "abc"]
    for guard in guards:
        guard.trigger()
    pair.spin()
    assert sorted(called) == ["a", "b", "c"]


def test_what_cannot_be_simulated_says_so(pair: Pair) -> None:
    with pytest.raises(RuntimeError, match="needs real ROS: the EventsExecutor is written in C"):
        EventsExecutor()
