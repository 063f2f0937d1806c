"""Clocks, and time that a topic tells."""

from __future__ import annotations

import threading
import time
from typing import Any

from builtin_interfaces.msg import Time as TimeMessage
from rclpy.clock import Clock, ClockType, JumpThreshold, ROSClock
from rclpy.duration import Duration
from rclpy.parameter import Parameter
from rclpy.time import Time
from rosgraph_msgs.msg import Clock as ClockMessage

from .declared import behaviour
from .graph import Graph, raised

DESIGN = "design.ros2.org/articles/clock_and_time.html"


class Told(Graph):
    """A node under simulated time, and one that tells it."""

    def __init__(self, **options: Any) -> None:
        super().__init__("teller", **options)
        simulated = [Parameter("use_sim_time", value=True)]
        self.told = self.node("told", parameter_overrides=simulated)
        self.clock = self.told.get_clock()
        self._publisher = self.nodes[0].create_publisher(ClockMessage, "/clock", 10)
        self.until(self._publisher.get_subscription_count)

    def tell(self, seconds: float) -> None:
        """Tell the time, and wait until the node knows it."""
        wanted = round(seconds * 1e9)
        second, rest = divmod(wanted, 10**9)
        self._publisher.publish(ClockMessage(clock=TimeMessage(sec=second, nanosec=rest)))
        if not self.until(lambda: self.clock.now().nanoseconds == wanted):
            raise TimeoutError("the node does not know the time")


@behaviour(
    expected=[True, 0, 5.5, 5.5, 2.0],
    source=DESIGN + ": zero until the first message of /clock; then what it says, also if that is before",
)
def a_topic_tells_the_time() -> Any:
    with Told() as told:
        seen = [told.clock.ros_time_is_active, told.clock.now().nanoseconds]
        told.tell(5.5)
        seen.append(told.clock.now().nanoseconds / 1e9)
        time.sleep(0.1)
        seen.append(told.clock.now().nanoseconds / 1e9)
        told.tell(2.0)
        return [*seen, told.clock.now().nanoseconds / 1e9]


@behaviour(expected=[1.1, 2.1, 3.1, 4.1], source=DESIGN + ": timers follow the node's clock")
def timers_follow_the_told_time() -> Any:
    with Told() as told:
        ticks: list[float] = []
        told.tell(0.1)
        told.told.create_timer(1.0, lambda: ticks.append(told.clock.now().nanoseconds / 1e9))
        for step in range(2, 42):
            told.tell(step / 10)
            told.spin(0.02)
        return ticks


@behaviour()
def a_timer_ticks_once_after_a_jump() -> Any:
    with Told() as told:
        ticks: list[float] = []
        told.tell(1.0)
        timer = told.told.create_timer(1.0, lambda: ticks.append(told.clock.now().nanoseconds / 1e9))
        told.tell(10.5)
        told.spin()
        first = len(ticks), round(timer.time_until_next_call() / 1e9, 3)
        told.tell(11.2)
        told.spin()
        return first, ticks


@behaviour()
def a_timer_after_a_jump_back() -> Any:
    with Told() as told:
        ticks: list[float] = []
        told.tell(100.0)
        told.told.create_timer(1.0, lambda: ticks.append(told.clock.now().nanoseconds / 1e9))
        told.tell(101.5)
        told.spin(0.1)
        told.tell(50.0)
        told.spin(0.1)
        told.tell(50.5)
        told.spin(0.1)
        told.tell(51.5)
        told.spin(0.1)
        return ticks


@behaviour(expected=[[], True], source=DESIGN + ": time that nobody tells stands still")
def a_timer_waits_while_time_stands_still() -> Any:
    with Told() as told:
        ticks: list[int] = []
        told.tell(1.0)
        timer = told.told.create_timer(0.05, lambda: ticks.append(1))
        told.spin(0.4)
        return ticks, timer.time_until_next_call() == 50_000_000


@behaviour()
def simulated_time_is_switched() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        clock = node.get_clock()
        seen: list[Any] = [clock.ros_time_is_active, clock.now().nanoseconds > 10**18]
        node.set_parameters([Parameter("use_sim_time", value=True)])
        seen += [clock.ros_time_is_active, clock.now().nanoseconds]
        node.set_parameters([Parameter("use_sim_time", value=False)])
        (wrong,) = node.set_parameters([Parameter("use_sim_time", value="yes")])
        return [*seen, clock.ros_time_is_active, clock.now().nanoseconds > 10**18, wrong.successful]


@behaviour()
def jumps_call_back() -> Any:
    told: list[Any] = []
    clock = ROSClock()
    clock._set_ros_time_is_active(True)
    threshold = JumpThreshold(
        min_forward=Duration(seconds=1), min_backward=Duration(seconds=-1), on_clock_change=True
    )
    handle = clock.create_jump_callback(
        threshold,
        pre_callback=lambda: told.append("before"),
        post_callback=lambda jump: told.append((jump.clock_change.name, jump.delta.nanoseconds / 1e9)),
    )
    for seconds in (10.0, 10.5, 12.0, 11.5, 9.0):
        clock.set_ros_time_override(Time(nanoseconds=int(seconds * 1e9), clock_type=ClockType.ROS_TIME))
    handle.unregister()
    clock.set_ros_time_override(Time(seconds=100, clock_type=ClockType.ROS_TIME))
    return told


@behaviour()
def switching_a_clock_calls_back() -> Any:
    told: list[str] = []
    clock = ROSClock()
    threshold = JumpThreshold(min_forward=None, min_backward=None, on_clock_change=True)
    with clock.create_jump_callback(
        threshold, post_callback=lambda jump: told.append(jump.clock_change.name)
    ):
        clock._set_ros_time_is_active(True)
        clock._set_ros_time_is_active(True)
        clock._set_ros_time_is_active(False)
    return told


@behaviour(
    expected=["ValueError", "ValueError", "ValueError", "ValueError"],
    source="rclpy.clock.JumpThreshold and Clock.create_jump_callback",
)
def thresholds_that_are_wrong() -> Any:
    clock = ROSClock()
    second, back = Duration(seconds=1), Duration(seconds=-1)
    good = JumpThreshold(min_forward=second, min_backward=back)
    return [
        raised(JumpThreshold, min_forward=back, min_backward=None),
        raised(JumpThreshold, min_forward=None, min_backward=second),
        raised(JumpThreshold, min_forward=None, min_backward=None, on_clock_change=False),
        raised(clock.create_jump_callback, good),
    ]


@behaviour(
    expected=[[True, True], [True, True], [True, True]],
    source="rclpy.clock.Clock.sleep_for: True if the full duration was slept",
)
def sleeping_on_a_clock() -> Any:
    found = []
    with Graph("node") as graph:
        for kind in (ClockType.SYSTEM_TIME, ClockType.STEADY_TIME, ClockType.ROS_TIME):
            begin = time.monotonic()
            slept = Clock(clock_type=kind).sleep_for(Duration(seconds=0.2), graph.context)
            found.append((slept, 0.19 <= time.monotonic() - begin < 1.0))
    return found


@behaviour(expected=[True, 3.0], source="rclpy.clock.Clock.sleep_until: True if until was reached")
def sleeping_until_a_told_time() -> Any:
    with Told() as told:
        told.tell(1.0)
        slept: list[Any] = []

        def sleep() -> None:
            reached = told.clock.sleep_until(Time(seconds=3, clock_type=ClockType.ROS_TIME), told.context)
            slept.extend((reached, told.clock.now().nanoseconds / 1e9))

        thread = threading.Thread(target=sleep, daemon=True)
        thread.start()
        time.sleep(0.1)
        told.tell(2.0)
        told.spin(0.1)
        early = list(slept)
        told.tell(3.0)
        told.until(lambda: len(slept) == 2)
        thread.join(5.0)
        return early + slept


@behaviour(
    expected=[False, False, "ValueError", "NotInitializedException"],
    source="rclpy.clock.Clock.sleep_until: False if it woke for another reason; what it raises",
)
def sleeps_that_end_early() -> Any:
    found: list[Any] = []
    clock = Clock(clock_type=ClockType.STEADY_TIME)
    ros = ROSClock()
    with Graph("node") as graph:
        long = Duration(seconds=60)
        switching = threading.Timer(0.2, lambda: ros._set_ros_time_is_active(True))
        switching.start()
        found.append(ros.sleep_for(long, graph.context))
        switching.join()
        ending = threading.Timer(0.2, graph.context.shutdown)
        ending.start()
        found.append(clock.sleep_for(long, graph.context))
        ending.join()
    with Graph("node") as graph:
        found.append(raised(clock.sleep_until, Time(seconds=1), graph.context))
        context = graph.context
    return [*found, raised(clock.sleep_for, Duration(seconds=1), context)]


@behaviour()
def a_rate_follows_the_told_time() -> Any:
    with Told() as told:
        told.tell(1.0)
        rate = told.told.create_rate(1.0)
        woken: list[float] = []

        def sleep() -> None:
            for _ in range(3):
                rate.sleep()
                woken.append(told.clock.now().nanoseconds / 1e9)

        thread = threading.Thread(target=sleep, daemon=True)
        thread.start()
        for half in range(3, 9):
            told.spin(0.1)
            told.tell(half / 2)
            told.spin(0.1)
        thread.join(5.0)
        return woken


@behaviour()
def clocks_of_every_kind() -> Any:
    system, steady = Clock(), Clock(clock_type=ClockType.STEADY_TIME)
    ros = Clock(clock_type=ClockType.ROS_TIME)
    first, second = steady.now(), steady.now()
    near = abs(ros.now().nanoseconds - system.now().nanoseconds) < 10**9
    return [
        system.clock_type.name,
        type(ros).__name__,
        first <= second,
        near,
        raised(Clock, clock_type="steady"),
        raised(ros.set_ros_time_override, 5),
        ros.ros_time_is_active,
        repr(system),
    ]


@behaviour()
def time_is_stamped_by_the_node_s_clock() -> Any:
    with Told() as told:
        told.tell(7.25)
        stamp = told.clock.now().to_msg()
        other = told.nodes[0].get_clock().now().nanoseconds
        return (stamp.sec, stamp.nanosec), other > 10**18
