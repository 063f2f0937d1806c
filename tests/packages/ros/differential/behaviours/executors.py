"""Executors, callback groups, futures, tasks, guard conditions and waitables."""

from __future__ import annotations

import threading
import time
from typing import Any

import rclpy
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.executors import (
    ExternalShutdownException,
    MultiThreadedExecutor,
    SingleThreadedExecutor,
)
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.task import Future
from rclpy.waitable import NumberOfEntities, Waitable
from std_msgs.msg import Int32

from .declared import behaviour
from .graph import Graph, connect, raised

GROUPS = "docs.ros.org, Using callback groups"
EXECUTOR = "rclpy.executors.Executor"


def four_threads(**options: Any) -> MultiThreadedExecutor:
    """An executor of four threads."""
    return MultiThreadedExecutor(4, **options)


def _most_at_once(make_groups: Any, in_threads: bool = True) -> int:
    """How many of two slow callbacks run at the same time."""
    options: dict[str, Any] = {"make_executor": four_threads, "in_thread": True} if in_threads else {}
    with Graph("node", **options) as graph:
        (node,) = graph
        lock = threading.Lock()
        running, most, calls = [0], [0], [0]

        def on_time() -> None:
            with lock:
                running[0] += 1
                most[0] = max(most[0], running[0])
            time.sleep(0.3)
            with lock:
                running[0] -= 1
                calls[0] += 1

        for group in make_groups():
            node.create_timer(0.05, on_time, callback_group=group)
        graph.until(lambda: calls[0] >= 4)
        return most[0]


@behaviour(
    expected={"one exclusive group": 1, "two exclusive groups": 2, "the default group": 1, "one thread": 1},
    source=GROUPS + ": callbacks of a mutually exclusive group are never run at the same time",
)
def callbacks_in_groups() -> Any:
    def one_group() -> list[CallbackGroup]:
        return [MutuallyExclusiveCallbackGroup()] * 2

    def two_groups() -> list[CallbackGroup]:
        return [MutuallyExclusiveCallbackGroup(), MutuallyExclusiveCallbackGroup()]

    return {
        "one exclusive group": _most_at_once(one_group),
        "two exclusive groups": _most_at_once(two_groups),
        "the default group": _most_at_once(lambda: [None, None]),
        "one thread": _most_at_once(lambda: [ReentrantCallbackGroup()] * 2, in_threads=False),
    }


@behaviour(
    expected=True,
    source=GROUPS + ": callbacks of a reentrant group may run at the same time, also with themselves",
)
def a_callback_runs_twice_at_once() -> Any:
    return _most_at_once(lambda: [ReentrantCallbackGroup()]) > 1


@behaviour()
def what_is_ready_is_executed_in_an_order() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        order: list[str] = []
        node.create_subscription(Int32, "numbers", lambda message: order.append("subscription"), 10)
        publisher = node.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        guard = node.create_guard_condition(lambda: order.append("guard"))
        timer = node.create_timer(0.05, lambda: order.append("timer"))
        graph.spin(0.02)
        publisher.publish(Int32())
        guard.trigger()
        time.sleep(0.2)
        graph.until(lambda: len(order) >= 3)
        timer.cancel()
        return order[:3]


@behaviour()
def several_of_a_kind_are_executed_in_the_order_they_were_made() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        order: list[str] = []
        publishers = []
        for name in ("c", "a", "b"):
            node.create_subscription(Int32, name, lambda message, name=name: order.append(name), 10)
        for name in ("a", "b", "c"):
            publishers.append(node.create_publisher(Int32, name, 10))
            connect(graph, publishers[-1])
        for publisher in publishers:
            publisher.publish(Int32())
        time.sleep(0.2)
        graph.until(lambda: len(order) == 3)
        return order


@behaviour()
def each_spin_executes_one_callback() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        heard: list[int] = []
        node.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), 10)
        publisher = node.create_publisher(Int32, "numbers", 10)
        connect(graph, publisher)
        graph.spin(0.1)
        for number in range(3):
            publisher.publish(Int32(data=number))
        time.sleep(0.2)
        counts = []
        while len(heard) < 3:
            before = len(heard)
            graph.executor.spin_once(timeout_sec=0.1)
            if len(heard) != before:
                counts.append(len(heard) - before)
        return counts


@behaviour(expected=[True, True], source=EXECUTOR + ".spin_once: seconds to wait; don't wait if 0")
def spinning_once_with_nothing_to_do() -> Any:
    with Graph("node") as graph:
        graph.spin(0.1)
        took = []
        for seconds in (0.0, 0.4):
            begin = time.monotonic()
            graph.executor.spin_once(timeout_sec=seconds)
            took.append(time.monotonic() - begin)
        return took[0] < 0.3, 0.39 <= took[1] < 1.0


@behaviour(
    expected=[[True, True], [False, True]],
    source=EXECUTOR + ".spin_until_future_complete: until a given future is done or a timeout occurs",
)
def spinning_until_a_future_is_done() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        found = []
        for delay in (0.1, 60.0):
            future: Future[int] = Future()
            timer = node.create_timer(delay, lambda future=future: future.set_result(1))
            begin = time.monotonic()
            graph.executor.spin_until_future_complete(future, timeout_sec=0.5)
            took = time.monotonic() - begin
            timer.cancel()
            found.append((future.done(), took < 0.45 if future.done() else 0.45 < took < 2.0))
        return found


@behaviour(
    expected=[True, False, ["node"], [], True],
    source=EXECUTOR + ".add_node: True if the node was added, False otherwise",
)
def nodes_are_added_and_removed() -> Any:
    with Graph() as graph:
        node = rclpy.create_node("node", context=graph.context)
        graph.nodes.append(node)
        added = graph.executor.add_node(node), graph.executor.add_node(node)
        names = [member.get_name() for member in graph.executor.get_nodes()]
        graph.executor.remove_node(node)
        left = [member.get_name() for member in graph.executor.get_nodes()]
        return [*added, names, left, graph.executor.shutdown()]


@behaviour()
def a_node_moves_to_another_executor() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        other = SingleThreadedExecutor(context=graph.context)
        first = node.executor is graph.executor
        other.add_node(node)
        moved = node.executor is other, [member.get_name() for member in graph.executor.get_nodes()]
        other.shutdown()
        return first, moved


@behaviour()
def a_removed_node_is_not_spun() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        ticks: list[int] = []
        node.create_timer(0.05, lambda: ticks.append(1))
        graph.until(lambda: ticks)
        graph.executor.remove_node(node)
        count = len(ticks)
        graph.spin()
        still = len(ticks) - count
        graph.executor.add_node(node)
        return still, graph.until(lambda: len(ticks) > count, 2.0)


@behaviour(expected=[[1], 3, "ValueError"], source=EXECUTOR + ".create_task: returns a Future")
def tasks_are_executed() -> Any:
    with Graph("node") as graph:
        done: list[int] = []
        graph.executor.create_task(done.append, 1)

        async def add(first: int, second: int) -> int:
            return first + second

        def fail() -> None:
            raise ValueError("no")

        total = graph.result(graph.executor.create_task(add, 1, 2))
        task = graph.executor.create_task(fail)
        raised(graph.spin, 0.2)
        return done, total, type(task.exception()).__name__


@behaviour()
def an_exception_in_a_task() -> Any:
    with Graph("node") as graph:

        def fail() -> None:
            raise ValueError("no")

        graph.executor.create_task(fail)
        return raised(graph.spin, 0.5)


@behaviour(
    expected=["begin", "between", "end"], source="rclpy.task: a coroutine that awaits gives way to others"
)
def a_coroutine_gives_way() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        order: list[str] = []
        future: Future[None] = Future(executor=graph.executor)

        async def wait() -> None:
            order.append("begin")
            await future
            order.append("end")

        def on_time() -> None:
            order.append("between")
            timer.cancel()
            future.set_result(None)

        task = graph.executor.create_task(wait)
        timer = node.create_timer(0.1, on_time)
        graph.until(task.done)
        return order


@behaviour(
    expected=[5, "ValueError", [True, None], [5, "later"]],
    source="rclpy.task.Future: result, exception, cancel, add_done_callback",
)
def futures() -> Any:
    done, failed, cancelled = Future(), Future(), Future()
    called: list[Any] = []
    done.add_done_callback(lambda future: called.append(future.result()))
    done.set_result(5)
    done.add_done_callback(lambda future: called.append("later"))
    failed.set_exception(ValueError("no"))
    cancelled.cancel()
    return [
        done.result(),
        raised(failed.result),
        (cancelled.cancelled(), cancelled.result()),
        called,
    ]


@behaviour()
def a_future_that_is_set_again() -> Any:
    future: Future[int] = Future()
    seen: list[Any] = [future.done(), future.result()]
    future.set_result(1)
    again = raised(future.set_result, 2)
    future.cancel()
    return [*seen, again, future.result(), future.cancelled(), future.exception()]


@behaviour()
def callbacks_of_a_future_are_executed_by_its_executor() -> Any:
    with Graph("node") as graph:
        called: list[int] = []
        future = graph.executor.create_future()
        future.add_done_callback(lambda future: called.append(future.result()))
        future.set_result(1)
        before = list(called)
        graph.until(lambda: called)
        return before, called


@behaviour(expected=1, source="rclpy.guard_condition.GuardCondition: a trigger wakes the executor once")
def a_guard_condition_is_triggered() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        called: list[int] = []
        guard = node.create_guard_condition(lambda: called.append(1))
        graph.spin(0.1)
        guard.trigger()
        guard.trigger()
        graph.spin()
        return len(called)


@behaviour()
def a_guard_condition_wakes_an_executor() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        called: list[int] = []
        guard = node.create_guard_condition(lambda: called.append(1))
        graph.spin(0.1)
        thread = threading.Timer(0.2, guard.trigger)
        thread.start()
        begin = time.monotonic()
        while not called:
            graph.executor.spin_once(timeout_sec=10.0)
        took = time.monotonic() - begin
        thread.join()
        destroyed = node.destroy_guard_condition(guard)
        return called, took < 5.0, destroyed, raised(guard.trigger)


@behaviour()
def a_task_adds_a_node_that_is_spun_at_once() -> Any:
    with Graph("node") as graph:
        late = rclpy.create_node("late", context=graph.context)
        graph.nodes.append(late)
        ticks: list[int] = []
        late.create_timer(0.05, lambda: ticks.append(1))
        graph.executor.create_task(lambda: graph.executor.add_node(late))
        begin = time.monotonic()
        for _ in range(3):
            graph.executor.spin_once(timeout_sec=5.0)
        return bool(ticks), time.monotonic() - begin < 4.0


@behaviour()
def a_task_does_what_the_executor_waits_for() -> Any:
    with Graph("node") as graph:
        future: Future[int] = Future()
        graph.executor.create_task(lambda: future.set_result(1))
        for _ in range(3):  # without a time-out: each must find the future done
            graph.executor.spin_once_until_future_complete(future)
        return future.result()


@behaviour()
def a_waitable_of_one_s_own() -> Any:
    # made here alone: where such a class is, executors over the simulation wait in another way
    class Waiting(Waitable[int]):
        """A waitable with a guard condition and a timer."""

        def __init__(self, node: Any, period: float) -> None:
            super().__init__(ReentrantCallbackGroup())
            self.executed: list[str] = []
            self._guard = GuardCondition(None, None, context=node.context)
            self._clock = Clock(clock_type=ClockType.STEADY_TIME)
            with self._clock.handle, node.context.handle:
                self._timer = rclpy_implementation.Timer(
                    self._clock.handle, node.context.handle, int(period * 1e9), True
                )
            self._guard_index = self._timer_index = -1
            self._ready: list[str] = []

        def trigger(self) -> None:
            self._guard.trigger()

        def is_ready(self, wait_set: Any) -> bool:
            if wait_set.is_ready("guard_condition", self._guard_index):
                self._ready.append("guard")
            if wait_set.is_ready("timer", self._timer_index):
                self._ready.append("timer")
            return bool(self._ready)

        def take_data(self) -> Any:
            taken, self._ready = self._ready, []
            if "timer" in taken:
                self._timer.call_timer_with_info()
                self._timer.cancel_timer()
            return taken

        async def execute(self, taken_data: Any) -> None:
            self.executed += taken_data

        def get_num_entities(self) -> NumberOfEntities:
            return NumberOfEntities(num_gcs=1, num_timers=1)

        def add_to_wait_set(self, wait_set: Any) -> None:
            self._guard_index = wait_set.add_guard_condition(self._guard.handle)
            self._timer_index = wait_set.add_timer(self._timer)

        def __enter__(self) -> None:
            self._guard.handle.__enter__()
            self._timer.__enter__()

        def __exit__(self, *arguments: Any) -> None:
            self._guard.handle.__exit__(*arguments)
            self._timer.__exit__(*arguments)

    with Graph("node") as graph:
        (node,) = graph
        waitable = Waiting(node, 0.3)
        node.add_waitable(waitable)
        graph.spin(0.1)
        waitable.trigger()
        graph.until(lambda: len(waitable.executed) == 2)
        node.remove_waitable(waitable)
        waitable.trigger()
        graph.spin(0.2)
        return waitable.executed


@behaviour()
def a_callback_may_make_and_destroy() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        heard: list[int] = []

        def on_time() -> None:
            timer.cancel()
            node.create_subscription(Int32, "numbers", lambda message: heard.append(message.data), 10)
            made.append(node.create_publisher(Int32, "numbers", 10))

        made: list[Any] = []
        timer = node.create_timer(0.05, on_time)
        graph.until(lambda: made and made[0].get_subscription_count())
        made[0].publish(Int32(data=1))
        graph.until(lambda: heard)
        return heard


@behaviour()
def spinning_in_a_callback() -> Any:
    with Graph("node") as graph:
        (node,) = graph
        told: list[str] = []
        ticks: list[int] = []

        def on_time() -> None:
            timer.cancel()
            told.append(raised(graph.executor.spin_once, timeout_sec=0.3))

        timer = node.create_timer(0.05, on_time)
        node.create_timer(0.1, lambda: ticks.append(1), callback_group=ReentrantCallbackGroup())
        graph.until(lambda: told)
        return told


@behaviour()
def a_shutdown_ends_spinning() -> Any:
    with Graph("node") as graph:
        ended: list[str] = []

        def spin() -> None:
            try:
                graph.executor.spin()
            except ExternalShutdownException:
                ended.append("ExternalShutdownException")
            else:
                ended.append("returned")

        thread = threading.Thread(target=spin, daemon=True)
        thread.start()
        time.sleep(0.2)
        graph.context.shutdown()
        thread.join(5.0)
        return ended


@behaviour()
def an_executor_that_is_shut_down_ends_spinning() -> Any:
    with Graph("node") as graph:
        ended: list[str] = []
        thread = threading.Thread(target=lambda: ended.append(raised(graph.executor.spin)), daemon=True)
        thread.start()
        time.sleep(0.2)
        answer = graph.executor.shutdown(timeout_sec=5.0)
        thread.join(5.0)
        return answer, ended, graph.executor.get_nodes()


@behaviour()
def an_exception_in_an_executor_of_threads() -> Any:
    with Graph("node", make_executor=four_threads) as graph:
        (node,) = graph

        def on_time() -> None:
            timer.cancel()
            raise ValueError("no")

        timer = node.create_timer(0.05, on_time)
        return raised(graph.spin, 1.0)


@behaviour()
def the_global_executor() -> Any:
    rclpy.init(args=[])
    node = rclpy.create_node("node")
    ticks: list[int] = []
    node.create_timer(0.05, lambda: ticks.append(1))
    end = time.monotonic() + 5
    while not ticks and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.1)
    future: Future[int] = Future()
    node.create_timer(0.1, lambda: future.done() or future.set_result(3))
    rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
    nodes = rclpy.get_global_executor().get_nodes()
    node.destroy_node()
    rclpy.shutdown()
    return bool(ticks), future.result(), nodes


@behaviour()
def a_node_is_destroyed_while_it_is_spun() -> Any:
    with Graph("node", "other") as graph:
        node, other = graph
        ticks: list[str] = []
        node.create_timer(0.05, lambda: ticks.append("node"))
        other.create_timer(0.05, lambda: ticks.append("other"))
        graph.until(lambda: len(set(ticks)) == 2)
        node.destroy_node()
        ticks.clear()
        graph.spin()
        return sorted(set(ticks)), len(graph.executor.get_nodes()), raised(node.get_name)


@behaviour()
def a_callback_waits_for_another_thread_s_callback() -> Any:
    with Graph("node", make_executor=four_threads, in_thread=True) as graph:
        (node,) = graph
        event = threading.Event()
        told: list[bool] = []

        def wait() -> None:
            waiter.cancel()
            told.append(event.wait(5.0))

        def release() -> None:
            releaser.cancel()
            event.set()

        waiter = node.create_timer(0.05, wait, callback_group=MutuallyExclusiveCallbackGroup())
        releaser = node.create_timer(0.2, release, callback_group=MutuallyExclusiveCallbackGroup())
        graph.until(lambda: told)
        return told


@behaviour()
def a_long_callback_holds_its_group_up() -> Any:
    with Graph("node", make_executor=four_threads, in_thread=True) as graph:
        (node,) = graph
        order: list[str] = []
        free = MutuallyExclusiveCallbackGroup()

        def slow() -> None:
            first.cancel()
            order.append("slow begins")
            time.sleep(0.6)
            order.append("slow ends")

        def once(name: str, timer: list[Any]) -> None:
            timer[0].cancel()
            order.append(name)

        same: list[Any] = []
        other: list[Any] = []
        first = node.create_timer(0.05, slow)
        same.append(node.create_timer(0.2, lambda: once("same group", same)))
        other.append(node.create_timer(0.2, lambda: once("other group", other), callback_group=free))
        graph.until(lambda: len(order) == 4)
        return order
