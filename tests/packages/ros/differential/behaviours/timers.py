"""Timers and rates."""

from __future__ import annotations

import threading
import time
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.time import Time
from rclpy.timer import TimerInfo
from std_msgs.msg import Int32

from .declared import behaviour
from .graph import Graph, raised

TIMER = "rclpy.timer.Timer"


@behaviour(
    expected=["a", "a", "a", "b", "a", "a", "a", "b"],
    source=TIMER + ": every timer_period_sec seconds the callback is called",
)
def two_timers() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        ticks: list[str] = []
        node.create_timer(0.2, lambda: ticks.append("a"))
        node.create_timer(0.7, lambda: ticks.append("b"))
        graph.until(lambda: ticks.count("b") == 2)
        # the second of the slow timer falls together with the seventh of the fast one
        return ticks[:7] + ticks[-1:]


@behaviour(expected=[1, True, None, 3, False], source=TIMER + ": cancel and reset")
def a_timer_is_cancelled_and_reset() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        ticks: list[int] = []

        def on_time() -> None:
            ticks.append(1)
            if len(ticks) in (1, 3):
                timer.cancel()

        timer = node.create_timer(0.05, on_time)
        graph.spin(0.4)
        first = len(ticks), timer.is_canceled(), timer.time_until_next_call()
        timer.reset()
        resumed = timer.is_canceled()
        graph.spin(0.4)
        return [*first, len(ticks), resumed]


@behaviour(expected=[[], True, 1], source=TIMER + ": if autostart is False, it is started by reset()")
def a_timer_starts_later() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        ticks: list[int] = []

        def on_time() -> None:
            ticks.append(1)
            timer.cancel()

        timer = node.create_timer(0.05, on_time, autostart=False)
        graph.spin(0.3)
        before = list(ticks), timer.is_canceled()
        timer.reset()
        graph.until(lambda: ticks)
        return [*before, len(ticks)]


@behaviour()
def a_timer_knows_its_times() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        timer = node.create_timer(10.0, lambda: None)
        left, passed = timer.time_until_next_call(), timer.time_since_last_call()
        second = 10**9
        return [
            timer.timer_period_ns,
            9 * second < left <= 10 * second,
            0 <= passed < second,
            timer.is_ready(),
            timer.is_canceled(),
            timer.clock is node.get_clock(),
        ]


@behaviour()
def a_period_is_changed() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        ticks: list[int] = []
        timer = node.create_timer(100.0, lambda: ticks.append(1))
        timer.timer_period_ns = 50_000_000
        timer.reset()
        ticked = graph.until(lambda: len(ticks) >= 2, 2.0)
        return ticked, timer.timer_period_ns


@behaviour()
def a_slow_callback_misses_ticks() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        calls: list[int] = []

        def on_time(info: TimerInfo) -> None:
            calls.append(info.expected_call_time.nanoseconds)
            if len(calls) == 1:
                time.sleep(0.75)
            if len(calls) == 3:
                timer.cancel()

        on_time.__annotations__["info"] = TimerInfo
        timer = node.create_timer(0.3, on_time)
        graph.until(lambda: len(calls) == 3)
        return [round((call - calls[0]) / 3e8, 2) for call in calls]


@behaviour()
def a_callback_is_told_when_it_was_due() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        told: list[Any] = []

        def on_time(info: TimerInfo) -> None:
            late = info.actual_call_time.nanoseconds - info.expected_call_time.nanoseconds
            told.append((0 <= late < 10**8, info.actual_call_time.clock_type.name))
            timer.cancel()

        on_time.__annotations__["info"] = TimerInfo
        timer = node.create_timer(0.1, on_time)
        graph.until(lambda: told)
        return told


@behaviour()
def a_destroyed_timer() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        ticks: list[int] = []
        timer = node.create_timer(0.05, lambda: ticks.append(1))
        graph.until(lambda: ticks)
        destroyed = node.destroy_timer(timer)
        count = len(ticks)
        graph.spin()
        return destroyed, len(ticks) - count, raised(timer.cancel), node.destroy_timer(timer)


@behaviour()
def a_timer_may_destroy_itself() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        ticks: list[bool] = []
        timer = node.create_timer(0.05, lambda: ticks.append(node.destroy_timer(timer)))
        graph.spin()
        return ticks


@behaviour()
def periods_that_are_wrong() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        ticks: list[int] = []
        timer = node.create_timer(0.0, lambda: ticks.append(1))
        ticked = graph.until(lambda: len(ticks) == 5, 2.0)
        timer.cancel()
        return [
            raised(node.create_timer, -1.0, print),
            raised(node.create_timer, "1", print),
            raised(node.create_rate, 0.0),
            ticked,
        ]


@behaviour(
    expected="ZeroDivisionError", source="rclpy.executors.Executor.spin_once raises what a callback raises"
)
def an_exception_in_a_timer_leaves_the_executor() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        node.create_timer(0.05, lambda: 1 // 0)
        return raised(graph.spin, 2.0)


@behaviour()
def a_timer_of_another_clock() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        ticks: list[str] = []
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        timer = node.create_timer(0.05, lambda: ticks.append("steady"), clock=steady)
        graph.until(lambda: ticks)
        return ticks[:1], timer.clock is steady


@behaviour(expected=[5, True], source="rclpy.timer.Rate.sleep: block until timer triggers")
def a_rate_in_a_thread() -> Any:
    with Graph("node", in_thread=True) as graph:
        (node,) = graph
        rate = node.create_rate(10.0)
        begin = time.monotonic()
        for _ in range(5):
            rate.sleep()
        tenths = (time.monotonic() - begin) / 0.1
        return int(tenths + 0.2), tenths < 9


@behaviour(
    expected=["RuntimeError", "ROSInterruptException"],
    source="rclpy.timer.Rate: cannot sleep because it has been destroyed; ROSInterruptException at shutdown",
)
def a_rate_that_cannot_sleep() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        rate, other = node.create_rate(10.0), node.create_rate(10.0)
        node.destroy_rate(rate)
        destroyed = raised(rate.sleep)
        graph.context.shutdown()
        return destroyed, raised(other.sleep)


@behaviour(expected="ROSInterruptException", source="rclpy.timer.Rate: raised when it is woken by a shutdown")
def a_shutdown_wakes_a_rate() -> Any:
    with Graph("node", in_thread=True) as graph:
        (node,) = graph
        rate = node.create_rate(0.01)
        told: list[str] = []
        thread = threading.Thread(target=lambda: told.append(raised(rate.sleep)), daemon=True)
        thread.start()
        time.sleep(0.2)
        graph.context.shutdown()
        thread.join(5.0)
        return told[0]


@behaviour()
def a_timer_publishes_and_a_subscription_counts() -> Any:
    with Graph("talker", "listener") as graph:
        talker, listener = graph
        heard: list[int] = []
        publisher = talker.create_publisher(Int32, "numbers", 10)
        count = iter(range(100))
        listener.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), 10)
        graph.until(publisher.get_subscription_count)
        talker.create_timer(0.05, lambda: publisher.publish(Int32(data=next(count))))
        graph.until(lambda: len(heard) == 6)
        return heard


@behaviour()
def a_watchdog_that_is_fed() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        told: list[str] = []

        def feed() -> None:
            told.append("fed")
            watchdog.reset()
            if len(told) == 4:
                feeder.cancel()

        def bark() -> None:
            told.append("barked")
            watchdog.cancel()

        watchdog = node.create_timer(0.6, bark)
        feeder = node.create_timer(0.2, feed)
        graph.until(lambda: "barked" in told)
        return told


@behaviour(
    expected=[["ValueError", "ValueError", "TypeError"], 1.5, -0.5, [True, False], "OverflowError"],
    source="rclpy.time.Time and rclpy.duration.Duration",
)
def arithmetic_of_times() -> Any:
    ros_time = Time(seconds=1, clock_type=ClockType.ROS_TIME)
    half = Duration(seconds=0.5)
    steady_time = Time(seconds=1, clock_type=ClockType.STEADY_TIME)
    return [
        [
            raised(Time, seconds=-1),
            raised(lambda: Time(seconds=1) - Duration(seconds=2)),
            raised(lambda: ros_time - steady_time),
        ],
        (ros_time + half).nanoseconds / 1e9,
        (ros_time - (ros_time + half)).nanoseconds / 1e9,
        [ros_time < ros_time + half, ros_time == ros_time + half],
        raised(Duration, seconds=2**40),
    ]


@behaviour()
def times_and_messages() -> Any:
    moment = Time(seconds=1, nanoseconds=500_000_000, clock_type=ClockType.ROS_TIME)
    message, span = moment.to_msg(), Duration(seconds=-1.5).to_msg()
    return [
        (message.sec, message.nanosec),
        (span.sec, span.nanosec),
        Time.from_msg(message) == moment,
        raised(Time.from_msg, span),
        moment.seconds_nanoseconds(),
        repr(moment),
        repr(Duration(nanoseconds=5) * 2),
        raised(lambda: moment == Time(seconds=1, clock_type=ClockType.SYSTEM_TIME)),
    ]
