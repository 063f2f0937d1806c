"""The cases of ``test_ros2``: one node ``/cell/mission`` that also hears and answers itself."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import pytest

from mutabot.model.answer import keep, restore
from mutabot.model.events import Problem
from mutabot.model.job import Idle
from mutabot.runtime.interception.trace import LOST
from tests.packages.ros.both import CLOSE, GOAL, LEVEL, Making, places
from tests.runtime.stage import Make, take_away

rclpy = pytest.importorskip("rclpy")
std_srvs = pytest.importorskip("std_srvs.srv")

BEGIN = """
    import time
    import rclpy
    from rclpy.node import Node
    from rclpy.qos import QoSProfile, DurabilityPolicy, ReliabilityPolicy
    from geometry_msgs.msg import Twist, Vector3
    from std_msgs.msg import Float64, Int32
    from std_srvs.srv import SetBool

    LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

    def until(done, node, executor=None):
        end = time.monotonic() + 60
        while not done():
            assert time.monotonic() < end
            if executor is None:
                rclpy.spin_once(node, timeout_sec=0.01)
            else:
                executor.spin_once(timeout_sec=0.01)

    def begin(name="mission"):
        return Node(name, namespace="/cell", enable_rosout=False, start_parameter_services=False)
"""


@pytest.fixture(scope="module", autouse=True)
def context() -> Iterator[None]:
    """ROS 2 with a topic that is remapped."""
    rclpy.init(args=["mission", "--ros-args", "-r", "level:=/line/level"])
    yield
    rclpy.try_shutdown()


@pytest.fixture
def make(make_stage: Make) -> Making:
    """Makes a stage of a program over ROS and a vocabulary."""
    return lambda program, vocabulary: make_stage("", BEGIN + program, vocabulary)


@pytest.fixture
def serving() -> Iterator[Any]:
    """A node of another that is spun in a thread: gives the node."""
    node = rclpy.create_node("server", namespace="/cell")
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    yield node
    executor.shutdown()
    thread.join()
    node.destroy_node()


@pytest.fixture
def closing(serving: Any) -> list[bool]:
    """A service that closes a gripper; what it was asked for."""
    asked: list[bool] = []

    def close(request: Any, response: Any) -> Any:
        asked.append(request.data)
        response.success = True
        return response

    serving.create_service(std_srvs.SetBool, "gripper/close", close)
    return asked


PUBLISHING = """
    def run():
        node = begin()
        received = []
        node.create_subscription(Twist, "goal", received.append, 10)
        goal = node.create_publisher(Twist, "goal", 10)
        until(goal.get_subscription_count, node)
        message = Twist(linear=Vector3(x=0.1, y=0.2, z=0.3))
        goal.publish(message)
        until(lambda: received, node)
        node.destroy_node()
        return received[0].linear, message.linear
"""


def test_what_is_published_is_mutated(make: Making) -> None:
    (came, given), activation = make(PUBLISHING, GOAL).mutated("reverse", "linear.y", index=1)
    assert (came.x, came.y, came.z) == (0.1, -0.2, 0.3)
    assert given.y == 0.2, "the program's own message stays as it is"
    assert activation.activity.acted == 1


def test_publishing_and_setting_up_are_sites_of_the_resolved_name(make: Making) -> None:
    stage = make(PUBLISHING, GOAL)
    stage.run(stage.session())
    assert places(stage) == {
        ("advertise /cell/goal", 'goal = node.create_publisher(Twist, "goal", 10)'),
        ("publish /cell/goal", "goal.publish(message)"),
    }


def test_a_publisher_of_a_lifecycle_node_publishes_while_it_is_active(make: Making) -> None:
    program = """
    from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn

    class Mission(LifecycleNode):
        def __init__(self):
            super().__init__("mission", namespace="/cell", enable_communication_interface=False)
            self.goal = self.create_lifecycle_publisher(Twist, "goal", 10)

        def on_activate(self, state):
            self.goal.publish(Twist())
            super().on_activate(state)
            self.goal.publish(Twist(linear=Vector3(y=0.2)))
            return TransitionCallbackReturn.SUCCESS

    def run():
        node = begin("listener")
        received = []
        node.create_subscription(Twist, "goal", received.append, 10)
        mission = Mission()
        until(mission.goal.get_subscription_count, node)
        mission.trigger_configure()
        mission.trigger_activate()
        until(lambda: received, node)
        mission.destroy_node()
        node.destroy_node()
        return [one.linear.y for one in received]
    """
    stage = make(program, GOAL)
    came, activation = stage.mutated("reverse", "linear.y", index=1)
    assert (came, activation.activity.acted) == ([-0.2], 1)


@pytest.mark.parametrize("spun", ["SingleThreadedExecutor", "MultiThreadedExecutor"])
@pytest.mark.parametrize("kind", ["def", "async def"])
def test_a_call_back_has_its_definition_as_site_and_its_remapped_topic(
    make: Making, kind: str, spun: str
) -> None:
    program = f"""
    from rclpy.executors import {spun}
    from rclpy.callback_groups import ReentrantCallbackGroup

    class Watch:
        def __init__(self):
            self.seen = []

        {kind} on_level(self, message, info):
            self.seen.append((message.data, "source_timestamp" in info))

    def run():
        node, watch, executor = begin(), Watch(), {spun}()
        executor.add_node(node)
        node.create_subscription(
            Float64, "level", watch.on_level, LATCHED, callback_group=ReentrantCallbackGroup()
        )
        level = node.create_publisher(Float64, "/line/level", LATCHED)
        level.publish(Float64(data=0.5))
        until(lambda: watch.seen, node, executor)
        executor.shutdown()
        node.destroy_node()
        return watch.seen
    """
    stage = make(program, LEVEL)
    seen, _ = stage.mutated("negate", "data", index=1)
    assert seen == [(-0.5, True)]
    assert ("receive /line/level", f"{kind} on_level(self, message, info):") in places(stage)


def test_waiting_for_a_message_is_a_site(make: Making) -> None:
    program = """
    import rclpy.wait_for_message as waiting

    def run():
        node = begin()
        level = node.create_publisher(Float64, "/line/level", LATCHED)
        level.publish(Float64(data=0.5))
        found, read = waiting.wait_for_message(Float64, node, "level", qos_profile=LATCHED, time_to_wait=10)
        nothing = waiting.wait_for_message(Float64, node, "silence", time_to_wait=0.05)
        node.destroy_node()
        return found, read.data, nothing
    """
    stage = make(program, LEVEL.replace("/line/level", "*"))
    assert stage.mutated("negate", "data")[0] == (True, -0.5, (False, None))
    assert {operation for operation, _ in places(stage)} == {"receive *"}


def test_a_message_that_is_kept_and_was_lost_does_not_come_again(make: Making) -> None:
    program = """
    import rclpy.wait_for_message as waiting

    def run():
        node = begin()
        level = node.create_publisher(Float64, "/line/level", LATCHED)
        level.publish(Float64(data=0.5))
        began = time.monotonic()
        found, _ = waiting.wait_for_message(Float64, node, "level", qos_profile=LATCHED, time_to_wait=1)
        node.destroy_node()
        return found, time.monotonic() - began
    """
    (found, waited), activation = make(program, LEVEL).mutated("drop", None)
    assert not found
    assert waited > 0.9, "the wait has its whole time"
    assert activation.activity.acted == 1


CALLING = """
    def run():
        node = begin()
        client = node.create_client(SetBool, "gripper/close")
        until(client.service_is_ready, node)
        future = client.call_async(SetBool.Request(data=True))
        rclpy.spin_until_future_complete(node, future, timeout_sec=10)
        node.destroy_node()
        return future.result().success
"""


def test_a_request_and_its_response_are_mutated(make: Making, closing: list[bool]) -> None:
    stage = make(CALLING, CLOSE)
    assert stage.mutated("opposite", "data", index=1)[0] is True
    assert closing == [True, False]
    assert places(stage) == {
        ("client /cell/gripper/close", 'client = node.create_client(SetBool, "gripper/close")'),
        ("call /cell/gripper/close", "future = client.call_async(SetBool.Request(data=True))"),
    }


def test_the_response_of_a_service_is_read(make: Making, closing: list[bool]) -> None:
    assert make(CALLING, CLOSE).mutated("misread", "success", index=1)[0] is False
    assert closing == [True, True]


def test_a_request_is_made_twice_without_waiting_in_the_program(make: Making, closing: list[bool]) -> None:
    assert make(CALLING, CLOSE).mutated("repeat", index=1)[0] is True
    assert closing == [True, True, True]


def test_a_call_that_waits_is_one_call(make: Making, closing: list[bool]) -> None:
    program = """
    import threading

    def run():
        node = begin()
        executor = rclpy.executors.SingleThreadedExecutor()
        executor.add_node(node)
        thread = threading.Thread(target=executor.spin, daemon=True)
        thread.start()
        client = node.create_client(SetBool, "gripper/close")
        client.wait_for_service(10)
        response = client.call(SetBool.Request(data=True), timeout_sec=10)
        executor.shutdown()
        thread.join()
        node.destroy_node()
        return response.success
    """
    stage = make(program, CLOSE)
    success, activation = stage.mutated("opposite", "data", index=1)
    assert (success, closing, activation.activity.hits) == (True, [True, False], 1)


def test_a_coroutine_that_awaits_a_service_goes_on(make: Making, closing: list[bool]) -> None:
    program = """
    from rclpy.callback_groups import ReentrantCallbackGroup

    class Mission(Node):
        def __init__(self):
            super().__init__("mission", namespace="/cell", enable_rosout=False)
            self.ended = []
            group = ReentrantCallbackGroup()  # else the answer would wait for the tick
            self.client = self.create_client(SetBool, "gripper/close", callback_group=group)

        async def tick(self):
            self.once.cancel()
            response = await self.client.call_async(SetBool.Request(data=True))
            self.ended.append(response.success)

    def run():
        node = Mission()
        until(node.client.service_is_ready, node)
        node.once = node.create_timer(0.01, node.tick)
        until(lambda: node.ended, node)
        node.destroy_node()
        return node.ended
    """
    assert make(program, CLOSE).mutated("opposite", "data", index=1)[0] == [True]
    assert closing == [True, False]


def test_a_request_of_another_type_is_refused_by_rclpy(make: Making) -> None:
    program = """
    def run():
        node = begin()
        client = node.create_client(SetBool, "gripper/close")
        try:
            client.call_async(Float64())
        except TypeError:
            return "TypeError"
        finally:
            node.destroy_node()
    """
    stage = make(program, CLOSE)
    assert stage.run(stage.session()) == "TypeError"


ACTION = """
    [[operation]]
    action = "/cell/turn"
    type = "test_msgs/Fibonacci"
    goal.order = { kind = "rotation", axis = "z", unit = "deg", mode = "by" }
    feedback."sequence[0]" = { kind = "angle", unit = "deg" }
    result."sequence[0]" = { kind = "angle", unit = "deg" }
"""
TURN = """
    from rclpy.action import ActionClient
    from test_msgs.action import Fibonacci

    def run(angle=30):
        node, read = begin(), []

        def on_feedback(message):
            read.append(message.feedback.sequence[0])

        client = ActionClient(node, Fibonacci, "turn")
        until(client.server_is_ready, node)
        sent = client.send_goal_async(Fibonacci.Goal(order=angle), feedback_callback=on_feedback)
        until(sent.done, node)
        handle = sent.result()
        if not handle.accepted:
            return [], None, None
        asked = handle.get_result_async()
        if not angle:
            handle.cancel_goal_async()
        until(lambda: asked.done() and read, node)  # they come on two ways, in any order
        answer = asked.result()
        node.destroy_node()
        return list(read), list(answer.result.sequence), answer.status
"""


@pytest.fixture
def turning(serving: Any) -> Iterator[list[int]]:
    """An action that turns: refuses 99, aborts at 13; the goals it was given."""
    from rclpy.action import ActionServer, CancelResponse, GoalResponse  # noqa: PLC0415
    from rclpy.callback_groups import ReentrantCallbackGroup  # noqa: PLC0415

    fibonacci = pytest.importorskip("test_msgs.action").Fibonacci
    goals: list[int] = []

    async def turn(handle: Any) -> Any:
        goals.append(handle.request.order)
        feedback = fibonacci.Feedback(sequence=[handle.request.order])
        handle.publish_feedback(feedback)
        if handle.request.order == 0:
            pause = rclpy.task.Future()
            timer = serving.create_timer(0.005, lambda: handle.is_cancel_requested and pause.set_result(0))
            await pause
            serving.destroy_timer(timer)
            handle.canceled()
        elif abs(handle.request.order) == 13:
            handle.abort()
        else:
            handle.succeed()
        return fibonacci.Result(sequence=[handle.request.order])

    server = ActionServer(
        serving,
        fibonacci,
        "turn",
        turn,
        callback_group=ReentrantCallbackGroup(),
        goal_callback=lambda goal: GoalResponse.REJECT if abs(goal.order) == 99 else GoalResponse.ACCEPT,
        cancel_callback=lambda handle: CancelResponse.ACCEPT,
    )
    yield goals
    server.destroy()


def test_an_action_has_its_goal_feedback_and_result_as_sites(make: Making, turning: list[int]) -> None:
    stage = make(TURN, ACTION)
    assert stage.run(stage.session()) == ([30], [30], 4)
    assert places(stage) == {
        ("client /cell/turn", 'client = ActionClient(node, Fibonacci, "turn")'),
        (
            "goal /cell/turn",
            "sent = client.send_goal_async(Fibonacci.Goal(order=angle), feedback_callback=on_feedback)",
        ),
        ("feedback /cell/turn", "def on_feedback(message):"),
        ("result /cell/turn", "asked = handle.get_result_async()"),
    }


def test_a_goal_is_reversed(make: Making, turning: list[int]) -> None:
    (_, result, _), _ = make(TURN, ACTION).mutated("reverse", "order", index=1)
    assert (turning, result) == ([30, -30], [-30])


@pytest.mark.parametrize(
    ("site", "read"),
    [("feedback /cell/turn", ([-30], [30], 4)), ("result /cell/turn", ([30], [-30], 4))],
)
def test_feedback_and_result_are_misread(make: Making, turning: list[int], site: str, read: object) -> None:
    assert make(TURN, ACTION).mutated("negate", "sequence[0]", index=site)[0] == read


def test_cancelling_is_a_site(make: Making, turning: list[int]) -> None:
    stage = make(TURN, ACTION)
    _, _, status = stage.run(stage.session(), "run", 0)
    assert status == 5
    assert ("cancel /cell/turn", "handle.cancel_goal_async()") in places(stage)


@pytest.mark.parametrize(("angle", "word"), [(13, "ABORTED"), (99, "REJECTED")])
def test_a_goal_that_ends_badly_is_refused_if_the_vocabulary_says_so(
    make: Making, turning: list[int], angle: int, word: str
) -> None:
    vocabulary = ACTION.replace("goal.order", f'refused = ["{word}"]\n    goal.order')
    program = TURN.replace("angle=30", f"angle={angle}")
    _, activation = make(program, vocabulary).mutated("reverse", "order", index=1)
    assert activation.activity.refusing_answer == f"/cell/turn: {word}"


PARAMETER = """
    [[operation]]
    parameter = "speed"
    value = { kind = "distance", unit = "m" }
"""


@pytest.mark.parametrize(
    "read",
    [
        'node.get_parameter("speed").value',
        'node.get_parameter_or("speed").value',
        'node.get_parameters(["speed"])[0].value',
        'node.get_parameters_by_prefix("")["speed"].value',
        'node.get_parameter("speed").get_parameter_value().double_value',
    ],
)
def test_a_parameter_is_read(make: Making, read: str) -> None:
    program = f"""
    def run():
        node = begin()
        node.declare_parameter("speed", 0.25)
        value = {read}
        node.destroy_node()
        return value
    """
    stage = make(program, PARAMETER)
    assert stage.run(stage.session()) == 0.25
    places_of_reading = [text for _, text in places(stage) if text.startswith("value")]
    assert places_of_reading == [f"value = {read}"]


def test_the_value_of_a_parameter_is_misread(make: Making) -> None:
    program = """
    def run():
        node = begin()
        value = node.declare_parameter("speed", 0.25).value
        node.destroy_node()
        return value
    """
    assert make(program, PARAMETER).mutated("negate", "value")[0] == -0.25


def test_a_part_of_a_parameter_is_misread(make: Making) -> None:
    program = """
    def run():
        node = begin()
        value = node.declare_parameter("speed", [0.25, 0.5]).value
        node.destroy_node()
        return list(value)
    """
    vocabulary = PARAMETER.replace("value =", 'value."[1]" =')
    assert make(program, vocabulary).mutated("negate", "[1]")[0] == [0.25, -0.5]


def test_a_parameter_that_is_set_is_one_of_a_list(make: Making) -> None:
    program = """
    from rclpy.parameter import Parameter

    def run():
        node = begin()
        node.declare_parameter("speed", 0.25)
        given = [Parameter("speed", value=0.5)]
        node.set_parameters(given)
        value = node.get_parameter("speed").value
        node.destroy_node()
        return value, given[0].value
    """
    vocabulary = """
    [[operation]]
    call = "rclpy.node:Node.set_parameters"
    arguments.parameter_list."[0].value" = { kind = "speed", unit = "m/s", range = [-1, 1] }
    """
    assert make(program, vocabulary).mutated("reverse", "parameter_list[0].value")[0] == (-0.5, 0.5)


def test_a_goal_that_is_not_sent_is_never_answered(make: Making, turning: list[int]) -> None:
    program = """
    from rclpy.action import ActionClient
    from test_msgs.action import Fibonacci

    RUNS = []

    def run():
        RUNS.append(1)
        node = begin()
        client = ActionClient(node, Fibonacci, "turn")
        until(client.server_is_ready, node)
        sent = client.send_goal_async(Fibonacci.Goal(order=30))
        rclpy.spin_until_future_complete(node, sent, timeout_sec=5.0 if len(RUNS) == 1 else 0.5)
        found = type(sent), sent.done()
        client.destroy()
        node.destroy_node()
        return found
    """
    named = make(program, ACTION)
    idle = Idle((LOST,)).data()
    result, activation = named.mutated("skip", idle=idle, index=1)
    assert result == (rclpy.task.Future, False)
    assert (activation.activity.acted, activation.activity.failure, turning) == (1, None, [30])


def test_a_call_that_returns_a_future_of_ros_is_kept_as_one_that_is_never_done() -> None:
    data = keep(rclpy.task.Future(), {})
    found = restore(data, {})
    assert (type(found), found.done(), data) == (rclpy.task.Future, False, {"pending": "rclpy.task.Future"})


def test_timers_and_rates_are_sites(make: Making) -> None:
    program = """
    import threading

    class Mission(Node):
        def __init__(self):
            super().__init__("mission", namespace="/cell", enable_rosout=False)
            self.ticks = 0
            self.create_timer(0.01, self.tick)

        def tick(self):
            self.ticks += 1

    def run():
        node = Mission()
        executor = rclpy.executors.MultiThreadedExecutor(2)
        executor.add_node(node)
        thread = threading.Thread(target=executor.spin, daemon=True)
        thread.start()
        rate = node.create_rate(100)
        rate.sleep()
        while not node.ticks:
            time.sleep(0.001)
        executor.shutdown()
        thread.join()
        node.destroy_node()
    """
    vocabulary = """
    [[operation]]
    timer = "Mission.tick"
    [[operation]]
    rate = "/cell/mission"
    """
    stage = make(program, vocabulary)
    stage.run(stage.session())
    assert places(stage) == {
        ("timer Mission.tick", "self.create_timer(0.01, self.tick)"),
        ("tick Mission.tick", "def tick(self):"),
        ("rate /cell/mission", "rate = node.create_rate(100)"),
        ("sleep /cell/mission", "rate.sleep()"),
    }


@pytest.mark.parametrize(
    ("operator", "variant", "quantity", "seen"),
    [
        ("wrong-durability", "", "durability", ("reliable", "volatile", 3, 0.5)),
        ("wrong-reliability", "", "reliability", ("best_effort", "transient_local", 3, 0.5)),
        ("short-queue", "", "depth", ("reliable", "transient_local", 1, 0.5)),
        ("wrong-deadline", "none", "deadline", None),
    ],
)
def test_a_publisher_is_set_up_with_other_qualities(
    make: Making, operator: str, variant: str, quantity: str, seen: tuple[Any, ...] | None
) -> None:
    program = """
    from rclpy.duration import Duration

    def run():
        node = begin()
        profile = QoSProfile(
            depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL, deadline=Duration(seconds=0.5)
        )
        goal = node.create_publisher(Twist, "goal", profile)
        found = goal.qos_profile
        node.destroy_node()
        return (
            found.reliability.name.lower(), found.durability.name.lower(), found.depth,
            found.deadline.nanoseconds / 1e9,
        )
    """
    came, activation = make(program, GOAL).mutated(operator, quantity, variant=variant)
    assert activation.activity.acted == 1, activation.activity
    if seen is not None:
        assert came == seen
    else:
        assert came[3] != 0.5


def test_a_publisher_is_set_up_under_another_name(make: Making) -> None:
    program = """
    def run():
        node = begin()
        name = node.create_publisher(Twist, "goal", 10).topic_name
        node.destroy_node()
        return name
    """
    stage = make(program, GOAL)
    assert stage.mutated("wrong-name", "name", variant="misspelt")[0] == "/cell/goal_misspelt"


def test_what_does_not_fit_a_type_is_reported_with_the_nearest_name(make: Making) -> None:
    stage = make(
        "\n    def run():\n        pass\n",
        GOAL.replace("linear.y", "liner.y") + CLOSE.replace("SetBool", "SetBol"),
    )
    session = stage.session(inspect=True)
    stage.run(session)
    session.finish()
    said = [line for line in stage.writer.lines if isinstance(line, Problem)]
    texts = " ".join(str(finding) for finding in said)
    assert "geometry_msgs/Twist has no field 'liner'" in texts
    assert "std_srvs has no SetBol among its services" in texts


def test_hooks_are_taken_away(make: Making) -> None:
    stage = make(PUBLISHING, GOAL)
    stage.run(stage.session())
    take_away(stage.sessions[-1])
    for kind, name in [
        (rclpy.node.Node, "create_publisher"),
        (rclpy.publisher.Publisher, "publish"),
        (rclpy.client.Client, "call_async"),
        (rclpy.clock.Clock, "now"),
    ]:
        assert not hasattr(getattr(kind, name), "__wrapped__"), f"{kind}.{name}"
