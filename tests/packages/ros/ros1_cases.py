"""The cases of ``test_ros1``: one node ``/cell/mission`` that also hears and answers itself."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest

from mutabot.model.answer import keep, restore
from mutabot.model.events import Problem
from mutabot_ros import _master
from tests.packages.ros.both import CLOSE, GOAL, LEVEL, Making, places
from tests.runtime.stage import Make, Stage, take_away

rospy = pytest.importorskip("rospy")
std_srvs = pytest.importorskip("std_srvs.srv")

BEGIN = """
    import time
    import rospy
    from geometry_msgs.msg import Point, Twist, Vector3
    from std_msgs.msg import Float64, Int32
    from std_srvs.srv import SetBool, SetBoolRequest

    def until(done):
        end = time.monotonic() + 60
        while not done():
            assert time.monotonic() < end
            time.sleep(0.002)
"""
#: publishes what it is told, once somebody listens, and returns what came
PUBLISHING = """
    def run():
        received = []
        listener = rospy.Subscriber("/cell/goal", Twist, received.append)
        goal = rospy.Publisher("goal", Twist, queue_size=10)
        until(goal.get_num_connections)
        message = Twist(linear=Vector3(0.1, 0.2, 0.3))
        goal.publish({published})
        until(lambda: received)
        listener.unregister()
        goal.unregister()
        return received[0].linear, message.linear
"""


@pytest.fixture(scope="module", autouse=True)
def node(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """A node in a namespace, with a topic that is remapped."""
    master = _master.start(str(tmp_path_factory.mktemp("ros1")))
    argv = ["mission.py", "level:=/line/level"]
    rospy.init_node("mission", argv, disable_rosout=True, disable_signals=True)
    yield
    rospy.signal_shutdown("all cases are over")
    master.stop()


@pytest.fixture
def make(make_stage: Make) -> Making:
    """Makes a stage of a program over ROS and a vocabulary."""
    return lambda program, vocabulary: make_stage("", BEGIN + program, vocabulary)


@pytest.fixture
def closing() -> Iterator[list[bool]]:
    """A service that closes a gripper; what it was asked for."""
    asked: list[bool] = []

    def close(request: Any) -> Any:
        asked.append(request.data)
        return std_srvs.SetBoolResponse(True, "done")

    service = rospy.Service("/cell/gripper/close", std_srvs.SetBool, close)
    yield asked
    service.shutdown("the case is over")


@pytest.mark.parametrize(
    "published",
    [
        "message",
        "linear=message.linear",
        "message.linear, message.angular",
    ],
)
def test_what_is_published_is_mutated_however_its_fields_are_given(make: Making, published: str) -> None:
    stage = make(PUBLISHING.replace("{published}", published), GOAL)
    (came, given), activation = stage.mutated("reverse", "linear.y", index=1)
    assert (came.x, came.y, came.z) == (0.1, -0.2, 0.3)
    assert given.y == 0.2, "the program's own message stays as it is"
    assert activation.activity.acted == 1


def test_publishing_and_setting_up_are_sites_of_the_resolved_name(make: Making) -> None:
    stage = make(PUBLISHING.replace("{published}", "message"), GOAL)
    stage.run(stage.session())
    assert places(stage) == {
        ("advertise /cell/goal", 'goal = rospy.Publisher("goal", Twist, queue_size=10)'),
        ("publish /cell/goal", "goal.publish(message)"),
    }


def test_what_is_left_out_is_not_published(make: Making) -> None:
    program = """
    def run():
        received = []
        listener = rospy.Subscriber("/cell/goal", Twist, received.append)
        goal = rospy.Publisher("goal", Twist, queue_size=10)
        until(goal.get_num_connections)
        goal.publish(Twist())
        goal.unregister()
        listener.unregister()
        return len(received)
    """
    came, activation = make(program, GOAL).mutated("skip", index=1, idle=None)
    assert (came, activation.activity.acted) == (0, 1)


@pytest.mark.parametrize("asked", ["True", "data=True", "SetBoolRequest(True)", "SetBoolRequest(data=True)"])
def test_a_request_is_mutated_however_it_is_given(make: Making, closing: list[bool], asked: str) -> None:
    program = f"""
    def run():
        close = rospy.ServiceProxy("gripper/close", SetBool)
        return close({asked}).success
    """
    stage = make(program, CLOSE)
    success, _ = stage.mutated("opposite", "data", index=1)
    assert closing == [True, False]
    assert success is True
    assert places(stage) == {
        ("client /cell/gripper/close", 'close = rospy.ServiceProxy("gripper/close", SetBool)'),
        ("call /cell/gripper/close", f"return close({asked}).success"),
    }


def test_messages_of_ros_1_that_were_answered_come_back() -> None:
    geometry = pytest.importorskip("geometry_msgs.msg")
    message = geometry.PointStamped(point=geometry.Point(1.0, 2.0, 3.0))
    message.header.stamp = rospy.Time(5, 6)
    back = restore(json.loads(json.dumps(keep(message, {}))), {})
    assert back == message
    assert type(back.header.stamp) is rospy.Time
    assert back.point is not message.point


def test_the_response_of_a_service_is_read(make: Making, closing: list[bool]) -> None:
    program = """
    def run():
        return rospy.ServiceProxy("gripper/close", SetBool)(True).success
    """
    success, _ = make(program, CLOSE).mutated("misread", "success", index=1)
    assert success is False
    assert closing == [True, True]


SUBSCRIBING = """
    class Watch:
        def __init__(self):
            self.seen = []

        def on_level(self, message, more=None):
            self.seen.append((message.data, more))

    def run():
        watch = Watch()
        level = rospy.Publisher("/line/level", Float64, queue_size=10, latch=True)
        before and level.publish(0.5)
        listener = rospy.Subscriber("level", Float64, watch.on_level{more})
        until(level.get_num_connections)
        before or level.publish(0.5)
        until(lambda: watch.seen)
        listener.unregister()
        level.unregister()
        return watch.seen
"""


@pytest.mark.parametrize("more", ["", ", callback_args='left'"])
def test_a_call_back_has_its_definition_as_site_and_its_remapped_topic(make: Making, more: str) -> None:
    stage = make(
        SUBSCRIBING.replace("{more}", more).replace("before and", "False and").replace("before or ", ""),
        LEVEL,
    )
    seen, _ = stage.mutated("negate", "data", index=1)
    assert seen == [(-0.5, "left" if more else None)]
    assert ("receive /line/level", "def on_level(self, message, more=None):") in places(stage)


def test_a_mutated_message_says_who_sent_it(make: Making) -> None:
    program = """
    seen = []

    def on_level(message):
        seen.append((message.data, message._connection_header["callerid"]))

    def run():
        seen.clear()
        level = rospy.Publisher("/line/level", Float64, queue_size=10, latch=True)
        level.publish(0.5)
        listener = rospy.Subscriber("level", Float64, on_level)
        until(lambda: seen)
        for one in (listener, level):
            one.unregister()
        return seen
    """
    seen, _ = make(program, LEVEL).mutated("negate", "data", index=1)
    assert seen == [(-0.5, "/cell/mission")]


def test_a_message_that_was_kept_for_who_comes_later_is_received(make: Making) -> None:
    program = """
    seen = []

    def on_level(message):
        seen.append(message.data)

    def run():
        seen.clear()
        level = rospy.Publisher("/line/level", Float64, queue_size=10, latch=True)
        level.publish(0.5)
        first = rospy.Subscriber("level", Float64, on_level)
        until(lambda: seen)
        second = rospy.Subscriber("level", Float64, on_level)  # this gets what the first one has
        for one in (first, second, level):
            one.unregister()
        return seen
    """
    seen, activation = make(program, LEVEL).mutated("negate", "data", index=1)
    assert seen == [-0.5, -0.5]
    assert activation.activity.hits == 2


def test_waiting_for_a_message_is_a_site(make: Making) -> None:
    program = """
    def run():
        level = rospy.Publisher("/line/level", Float64, queue_size=10, latch=True)
        level.publish(0.5)
        read = rospy.wait_for_message("level", Float64, rospy.Duration(10))
        level.unregister()
        return read.data
    """
    stage = make(program, LEVEL)
    read, _ = stage.mutated("negate", "data")
    assert read == -0.5
    assert places(stage) == {
        ("receive /line/level", 'read = rospy.wait_for_message("level", Float64, rospy.Duration(10))')
    }


def test_a_message_that_is_kept_and_was_lost_does_not_come_again(make: Making) -> None:
    program = """
    def run():
        level = rospy.Publisher("/line/level", Float64, queue_size=10, latch=True)
        level.publish(0.5)
        try:
            rospy.wait_for_message("level", Float64, 1.0)
        except rospy.ROSException as error:
            return str(error)
        finally:
            level.unregister()
    """
    told, activation = make(program, LEVEL).mutated("drop", None)
    assert "timeout exceeded" in told
    assert activation.activity.acted == 1


def test_waiting_in_vain_ends_as_it_does_without_us(make: Making) -> None:
    program = """
    def run():
        try:
            rospy.wait_for_message("level", Float64, 0.1)
        except rospy.ROSException as error:
            return str(error)
    """
    stage = make(program, LEVEL)
    assert "timeout exceeded" in stage.run(stage.session())


ACTION = """
    [[operation]]
    action = "/cell/turn"
    type = "actionlib/Test"
    goal.goal = { kind = "rotation", axis = "z", unit = "deg", mode = "by" }
    feedback.feedback = { kind = "angle", unit = "deg" }
    result.result = { kind = "angle", unit = "deg" }
"""


@pytest.fixture(scope="module")
def goals() -> list[int]:
    """An action that turns, which cannot be taken down again; the goals it was given."""
    actionlib = pytest.importorskip("actionlib")
    messages = pytest.importorskip("actionlib.msg")
    goals: list[int] = []

    def turn(goal: Any) -> None:
        goals.append(goal.goal)
        rospy.sleep(0.05)  # a client that is answered at once misses it: it does not know yet what it sent
        server.publish_feedback(messages.TestFeedback(goal.goal))
        rospy.sleep(0.05)  # nor does feedback come before the result by itself
        if goal.goal == -13:
            server.set_aborted()
            return
        while not goal.goal:
            if server.is_preempt_requested():
                server.set_preempted()
                return
            rospy.sleep(0.01)
        server.set_succeeded(messages.TestResult(goal.goal))

    server = actionlib.SimpleActionServer("turn", messages.TestAction, turn, auto_start=False)
    server.start()
    return goals


@pytest.fixture
def turning(goals: list[int]) -> list[int]:
    """The same, in a new case."""
    goals.clear()
    return goals


TURN = """
    from actionlib import SimpleActionClient
    from actionlib.msg import TestAction, TestGoal

    def run(angle=30):
        read = []

        def on_feedback(feedback):
            read.append(feedback.feedback)

        def on_end(status, result):
            read.append(result.result)

        client = SimpleActionClient("turn", TestAction)
        client.wait_for_server()
        client.send_goal(TestGoal(goal=angle), feedback_cb=on_feedback, done_cb=on_end)
        if not angle:
            until(lambda: client.get_state() == 1)  # one that has not begun may be recalled
            client.cancel_goal()
        assert client.wait_for_result(rospy.Duration(20))
        return read, client.get_result().result, client.get_state()
"""


def test_an_action_has_its_goal_feedback_and_result_as_sites(make: Making, turning: list[int]) -> None:
    stage = make(TURN, ACTION)
    assert stage.run(stage.session()) == ([30, 30], 30, 3)
    assert places(stage) == {
        ("client /cell/turn", 'client = SimpleActionClient("turn", TestAction)'),
        (
            "goal /cell/turn",
            "client.send_goal(TestGoal(goal=angle), feedback_cb=on_feedback, done_cb=on_end)",
        ),
        ("feedback /cell/turn", "def on_feedback(feedback):"),
        ("result /cell/turn", "def on_end(status, result):"),
        ("result /cell/turn", "return read, client.get_result().result, client.get_state()"),
    }
    assert turning == [30]


def test_a_goal_is_reversed(make: Making, turning: list[int]) -> None:
    (read, result, _), _ = make(TURN, ACTION).mutated("reverse", "goal", index=1)
    assert turning == [30, -30]
    assert (read, result) == ([-30, -30], -30)


def test_feedback_is_misread(make: Making, turning: list[int]) -> None:
    (read, result, _), _ = make(TURN, ACTION).mutated("negate", "feedback", index="feedback /cell/turn")
    assert (read, result) == ([-30, 30], 30)


def test_cancelling_is_a_site(make: Making, turning: list[int]) -> None:
    stage = make(TURN, ACTION)
    _, _, state = stage.run(stage.session(), "run", 0)
    assert state in (2, 8)  # preempted or recalled: the server decides
    assert ("cancel /cell/turn", "client.cancel_goal()") in places(stage)


def test_a_goal_that_is_aborted_is_refused_if_the_vocabulary_says_so(
    make: Making, turning: list[int]
) -> None:
    vocabulary = ACTION.replace("goal.goal", 'refused = ["ABORTED"]\n    goal.goal')
    program = TURN.replace("read.append(result.result)", "pass").replace("client.get_result().result", "0")
    program = program.replace("run(angle=30)", "run(angle=13)")  # the server turns no 13 degrees back
    (_, _, state), activation = make(program, vocabulary).mutated("reverse", "goal", index=1)
    assert (turning, state) == ([13, -13], 4)
    assert activation.activity.refusing_answer == "/cell/turn: ABORTED"


def test_a_message_that_follows_says_that_a_command_is_refused(make: Making) -> None:
    vocabulary = GOAL.replace(
        "fields.", 'refused = { topic = "/cell/ended", path = "data", values = [5] }\n    fields.'
    )
    program = """
    def run():
        heard = []
        ended = rospy.Publisher("ended", Int32, queue_size=10)
        listener = rospy.Subscriber("/cell/ended", Int32, heard.append)
        server = rospy.Subscriber("goal", Twist, lambda m: ended.publish(5 if m.linear.y < 0 else 3))
        goal = rospy.Publisher("goal", Twist, queue_size=10)
        until(lambda: goal.get_num_connections() and ended.get_num_connections())
        goal.publish(Twist(linear=Vector3(0.1, 0.2, 0.3)))
        until(lambda: heard)
        for one in (ended, listener, server, goal):
            one.unregister()
        return heard[0].data
    """
    end, activation = make(program, vocabulary).mutated("reverse", "linear.y", index=1)
    assert end == 5
    assert activation.activity.refusing_answer == "/cell/ended: data 5"


PARAMETER = """
    [[operation]]
    parameter = "/cell/speed"
    value = { kind = "distance", unit = "m" }
"""


@pytest.mark.parametrize(
    "call", ['get_param("speed")', 'get_param("speed", 1.0)', 'get_param_cached("speed")']
)
def test_a_parameter_is_read(make: Making, call: str) -> None:
    rospy.set_param("/cell/speed", 0.25)
    read, _ = make(f"\n    def run():\n        return rospy.{call}\n", PARAMETER).mutated("negate", "value")
    assert read == -0.25


def test_a_parameter_that_is_not_set_has_its_default(make: Making) -> None:
    vocabulary = PARAMETER.replace("speed", "missing")
    stage = make('\n    def run():\n        return rospy.get_param("missing", 7.0)\n', vocabulary)
    assert stage.run(stage.session()) == 7.0


def test_a_transform_is_read(make: Making) -> None:
    pytest.importorskip("tf2_ros", reason="no tf2_ros: install Debian's python3-tf2-ros")
    vocabulary = """
    [[operation]]
    tf = "base -> tool"
    fields."transform.translation.x" = { kind = "position", axis = "x", unit = "m" }
    """
    program = """
    import tf2_ros
    from geometry_msgs.msg import Quaternion, TransformStamped

    def run():
        told = TransformStamped(child_frame_id="tool")
        told.header.frame_id = "base"
        told.transform.translation.x = 0.5
        told.transform.rotation = Quaternion(0, 0, 0, 1)
        buffer = tf2_ros.Buffer(debug=False)
        buffer.set_transform_static(told, "case")
        return buffer.lookup_transform("base", "tool", rospy.Time()).transform.translation.x
    """
    read, _ = make(program, vocabulary).mutated("negate", "transform.translation.x")
    assert read == -0.5


def test_timers_and_rates_are_sites(make: Making) -> None:
    vocabulary = """
    [[operation]]
    timer = "on_time"
    [[operation]]
    rate = "/cell/mission"
    """
    program = """
    ticks = []

    def on_time(event):
        ticks.append(event)

    def run():
        timer = rospy.Timer(rospy.Duration(0.01), on_time)
        rate = rospy.Rate(100)
        for _ in range(5):
            rate.sleep()
        until(lambda: ticks)
        timer.shutdown()
    """
    stage = make(program, vocabulary)
    stage.run(stage.session())
    assert places(stage) == {
        ("timer on_time", "timer = rospy.Timer(rospy.Duration(0.01), on_time)"),
        ("tick on_time", "def on_time(event):"),
        ("rate /cell/mission", "rate = rospy.Rate(100)"),
        ("sleep /cell/mission", "rate.sleep()"),
    }


def problems(stage: Stage) -> list[tuple[str, str]]:
    session = stage.session(inspect=True)
    stage.run(session)
    session.inspect_targets()
    return [(line.key, line.text) for line in stage.writer.lines if isinstance(line, Problem)]


@pytest.mark.parametrize(
    ("vocabulary", "key", "text"),
    [
        (GOAL.replace("geometry_msgs", "geometri_msgs"), "type", "no package 'geometri_msgs'"),
        (GOAL.replace("Twist", "Twits"), "type", "geometry_msgs has no Twits"),
        (
            GOAL.replace("linear.y", "linear.yy"),
            "fields.linear.yy",
            "geometry_msgs/Vector3 has no field 'yy'",
        ),
        (
            CLOSE.replace("request.data", "request.closed"),
            "request.closed",
            "has no field 'closed'; it has data",
        ),
        (CLOSE.replace("response.success", "response.ok"), "response.ok", "it has success, message"),
        (
            GOAL.replace("Twist", "Pose").replace("linear.y", "position.y"),
            "type",
            "program uses geometry_msgs/Twist",
        ),
        (
            CLOSE + 'refused = { path = "stat", values = [5] }\n',
            "refused.path",
            "std_srvs/SetBoolResponse has no field 'stat'; it has success, message",
        ),
        (
            GOAL + 'refused = { topic = "/cell/goal", path = "linear.w", values = [5] }\n',
            "refused.path",
            "/cell/goal: geometry_msgs/Vector3 has no field 'w'",
        ),
        (ACTION.replace("goal.goal", "goal.angle"), "goal.angle", "actionlib/TestGoal has no field 'angle'"),
        (ACTION.replace("result.result", "result.sum"), "result.sum", "it has result"),
    ],
)
def test_a_type_or_field_that_does_not_exist_is_reported(
    make: Making, vocabulary: str, key: str, text: str
) -> None:
    program = """
    def run():
        rospy.Publisher("goal", Twist, queue_size=1).unregister()
        rospy.Subscriber("goal", Twist, print).unregister()
    """
    (found,) = problems(make(program, vocabulary))
    assert found[0] == key
    assert text in found[1]


def test_fields_inside_arrays_and_moments_exist(make: Making) -> None:
    vocabulary = """
    [[operation]]
    topic = "/cell/path"
    direction = "publish"
    type = "trajectory_msgs/JointTrajectory"
    fields."points[-1].positions[0]" = { kind = "rotation", axis = "x", unit = "rad", mode = "to" }
    fields."points[0].time_from_start.secs" = { kind = "duration", unit = "s" }
    """
    pytest.importorskip("trajectory_msgs")
    assert problems(make("\n    def run():\n        pass\n", vocabulary)) == []


def test_nothing_of_us_is_left_when_a_session_is_over(make: Making) -> None:
    actionlib = pytest.importorskip("actionlib")
    places = [
        (rospy.Publisher, "__init__"),
        (rospy.Publisher, "publish"),
        (rospy.Subscriber, "__init__"),
        (rospy.ServiceProxy, "call"),
        (rospy, "wait_for_message"),
        (rospy, "get_param"),
        (rospy, "get_rostime"),
        (rospy.Rate, "sleep"),
        (rospy.Timer, "__init__"),
        (actionlib.SimpleActionClient, "send_goal"),
    ]
    before = [vars(owner)[name] for owner, name in places]
    session = make("", GOAL).session()
    assert all(vars(owner)[name] is not was for (owner, name), was in zip(places, before, strict=True))
    take_away(session)
    assert [vars(owner)[name] for owner, name in places] == before
