"""Simulated time and threads: run by ``test_ros2_simulation.py`` over the simulation."""

from __future__ import annotations

import asyncio
import datetime
import importlib
import importlib.util
import queue
import subprocess
import threading
import time
import urllib.request  # noqa: F401  (a library that uses threads, to see that it is as it was)
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import TimeoutError as FutureTimeout

import pytest
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger

from ros_in_process.machine.scheduler import Deadlock


def test_sleeping_takes_no_wall_time() -> None:
    before = time.monotonic(), time.time(), datetime.datetime.now()
    time.sleep(3600 - 1)
    after = time.monotonic(), time.time(), datetime.datetime.now()
    assert after[0] - before[0] == pytest.approx(3599, abs=0.001)
    assert after[1] - before[1] == pytest.approx(3599, abs=0.001)
    assert (after[2] - before[2]).total_seconds() == pytest.approx(3599, abs=0.001)


def test_two_readings_of_a_clock_differ() -> None:
    readings = [time.perf_counter() for _ in range(10)]
    assert sorted(set(readings)) == readings


def test_a_loop_that_polls_does_not_stop_time() -> None:
    ready = threading.Event()
    threading.Timer(20.0, ready.set).start()
    end = time.monotonic() + 30.0
    polls = 0
    while not ready.is_set() and time.monotonic() < end:
        polls += 1
    assert ready.is_set()
    assert polls < 30_000


def test_threads_take_turns_in_one_order() -> None:
    said: list[str] = []
    lock = threading.Lock()

    def speak(name: str, pause: float) -> None:
        for _ in range(3):
            time.sleep(pause)
            with lock:
                said.append(name)

    threads = [threading.Thread(target=speak, args=arguments) for arguments in (("a", 0.2), ("b", 0.3))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert "".join(said) == "ababab"


def test_queues_pools_and_conditions_wait_in_simulated_time() -> None:
    numbers: queue.Queue[int] = queue.Queue()
    with pytest.raises(queue.Empty):
        numbers.get(timeout=5.0)
    with ThreadPoolExecutor(2) as pool:
        slow = pool.submit(time.sleep, 10.0)
        with pytest.raises(FutureTimeout):
            slow.result(timeout=1.0)
        assert list(pool.map(lambda number: number * 2, range(3))) == [0, 2, 4]
    barrier = threading.Barrier(2)
    threading.Timer(1.0, barrier.wait).start()
    barrier.wait()
    own = threading.local()
    own.value = 1
    seen: list[bool] = []
    thread = threading.Thread(target=lambda: seen.append(hasattr(own, "value")))
    thread.start()
    thread.join(timeout=1.0)
    assert seen == [False]
    assert not thread.is_alive()


def test_asyncio_waits_in_simulated_time() -> None:
    async def late(seconds: float) -> float:
        await asyncio.sleep(seconds)
        return seconds

    async def main() -> list[float]:
        return await asyncio.gather(late(2.0), late(1.0), asyncio.to_thread(time.sleep, 3.0))

    before = time.monotonic()
    assert asyncio.run(main()) == [2.0, 1.0, None]
    assert time.monotonic() - before == pytest.approx(3.0, abs=0.01)
    loop = asyncio.new_event_loop()
    threading.Thread(target=loop.run_forever, daemon=True).start()
    assert asyncio.run_coroutine_threadsafe(late(5.0), loop).result(timeout=6.0) == 5.0
    loop.call_soon_threadsafe(loop.stop)


def test_everybody_waiting_for_ever_is_a_deadlock() -> None:
    with pytest.raises(Deadlock, match="all threads wait, and nothing will ever wake one"):
        threading.Event().wait()
    first, second = threading.Lock(), threading.Lock()

    def take(left: threading.Lock, right: threading.Lock) -> None:
        with left:
            time.sleep(0.1)
            with right:
                pass

    threads = [
        threading.Thread(target=take, args=pair, daemon=True) for pair in ((first, second), (second, first))
    ]
    for thread in threads:
        thread.start()
    with pytest.raises(Deadlock, match="waits for a lock or a condition"):
        threads[0].join()


def test_a_graph_that_waits_for_ever_is_a_deadlock() -> None:
    with rclpy.init():
        node = rclpy.create_node("waiting")
        client = node.create_client(Trigger, "nowhere")
        with pytest.raises(Deadlock, match="the test's thread waits for ROS"):
            rclpy.spin_until_future_complete(node, client.call_async(Trigger.Request()))
        node.destroy_node()


def test_a_synchronous_call_in_a_callback_that_blocks_itself_is_a_deadlock() -> None:
    with rclpy.init():
        node = rclpy.create_node("caller")
        node.create_service(Trigger, "answer", lambda request, response: response)
        client = node.create_client(Trigger, "answer")
        node.create_timer(0.1, lambda: client.call(Trigger.Request()))
        with pytest.raises(Deadlock):
            rclpy.spin(node)


def test_a_node_that_goes_on_for_ever_ends_at_the_limit_of_simulated_time() -> None:
    with rclpy.init():
        node = rclpy.create_node("ticking")
        node.create_timer(10.0, lambda: None)
        with pytest.raises(Deadlock, match="limit of simulated time has passed"):
            rclpy.spin(node)


def test_clocks_follow_clock_messages() -> None:
    with rclpy.init():
        teller = rclpy.create_node("teller")
        told = rclpy.create_node("told", parameter_overrides=[Parameter("use_sim_time", value=True)])
        executor = MultiThreadedExecutor(2)
        executor.add_node(teller)
        executor.add_node(told)
        clock = teller.create_publisher(Clock, "/clock", 10)
        seconds = iter(range(1, 100))

        def tell() -> None:
            message = Clock()
            message.clock.sec = next(seconds)
            clock.publish(message)

        teller.create_timer(0.01, tell)
        thread = threading.Thread(target=executor.spin, daemon=True)
        thread.start()
        time.sleep(0.05)
        before = time.monotonic()
        start = told.get_clock().now()
        assert told.get_clock().sleep_for(Duration(seconds=10))
        assert (told.get_clock().now() - start).nanoseconds == 10 * 10**9
        assert time.monotonic() - before == pytest.approx(0.1, abs=0.02)
        executor.shutdown()
        thread.join()


def test_rates_and_synchronous_calls_work_in_threads() -> None:
    with rclpy.init():
        node = rclpy.create_node("busy")
        group = ReentrantCallbackGroup()
        node.create_service(Trigger, "answer", lambda request, response: response, callback_group=group)
        client = node.create_client(Trigger, "answer", callback_group=group)
        executor = MultiThreadedExecutor(3)
        executor.add_node(node)
        thread = threading.Thread(target=executor.spin, daemon=True)
        thread.start()
        rate = node.create_rate(20)
        before = time.monotonic()
        for _ in range(10):
            rate.sleep()
            assert client.call(Trigger.Request(), timeout_sec=1.0) is not None
        assert time.monotonic() - before == pytest.approx(0.5, abs=0.01)
        executor.shutdown()
        thread.join(timeout=1.0)
        assert not thread.is_alive()


def test_modules_that_are_imported_by_name_are_the_simulated_ones() -> None:
    assert importlib.import_module("time") is time
    assert importlib.import_module("concurrent.futures").ThreadPoolExecutor is ThreadPoolExecutor
    assert importlib.util.find_spec("time") is not None


def test_others_see_real_time_and_real_processes() -> None:
    import logging  # noqa: PLC0415  (any module of the library)

    assert logging.time is not time
    assert logging.threading is not threading
    assert subprocess.run(["true"], check=False).returncode == 0
