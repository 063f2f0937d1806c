"""Nodes that tests start as processes: run by ``test_ros2_simulation.py`` over the simulation."""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

COUNTER = str(Path(__file__).parent / "nodes" / "counter.py")


@pytest.fixture
def node() -> Iterator[Node]:
    rclpy.init()
    node = rclpy.create_node("test")
    yield node
    node.destroy_node()
    rclpy.shutdown()
    while started:
        started.pop().kill()
    time.sleep(30.0)


started: list[subprocess.Popen[str]] = []


def start(*arguments: str, **options: Any) -> subprocess.Popen[str]:
    started.append(subprocess.Popen([sys.executable, "-u", COUNTER, *arguments], text=True, **options))
    return started[-1]


def heard(node: Node, seconds: float) -> list[int]:
    numbers: list[int] = []
    subscription = node.create_subscription(
        Int32, "/numbers", lambda message: numbers.append(message.data), 10
    )
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        rclpy.spin_once(node, timeout_sec=left)
    node.destroy_subscription(subscription)
    return numbers


def test_a_node_is_a_process_with_arguments_of_its_own(node: Node) -> None:
    process = start("--ros-args", "-p", "step:=5", "-r", "numbers:=/other")
    assert heard(node, 1.0) == []
    assert ("/other", ["std_msgs/msg/Int32"]) in node.get_topic_names_and_types()
    process.send_signal(signal.SIGINT)
    assert process.wait(5) == 3
    process = start("--ros-args", "-p", "step:=5")
    numbers = heard(node, 1.05)
    assert numbers == [5 * number for number in range(numbers[0] // 5, numbers[0] // 5 + len(numbers))]
    assert len(numbers) == 10


def test_each_process_has_modules_of_its_own_and_a_main_thread(node: Node) -> None:
    processes = [start("--ros-args", "-r", f"__node:=counter{number}") for number in range(2)]
    time.sleep(1.05)
    later = start("--ros-args", "-r", "__node:=counter2")
    time.sleep(1.0)
    told = []
    for number in range(3):
        client = node.create_client(Trigger, f"/counter{number}/how_many")
        assert client.wait_for_service(timeout_sec=1.0)
        future = client.call_async(Trigger.Request())
        rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)
        told.append(future.result().message)
    assert told == ["20 of MainThread", "20 of MainThread", "10 of MainThread"]
    assert "counter" not in sys.modules
    assert [process.poll() for process in (*processes, later)] == [None, None, None]


@pytest.mark.parametrize(
    ("signum", "error"), [(signal.SIGINT, "KeyboardInterrupt"), (signal.SIGTERM, "ExternalShutdownException")]
)
def test_signals_mean_what_they_mean(node: Node, signum: int, error: str) -> None:
    process = start(stdout=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stdout.readline() == "counting\n"
    time.sleep(1.0)
    before = time.monotonic()
    process.send_signal(signum)
    assert process.poll() is None
    assert process.wait(timeout=5) == 3
    assert time.monotonic() - before == pytest.approx(0.5, abs=0.05)
    assert process.stdout.read() == f"{error}\ntidied up\n"
    assert node.count_publishers("/numbers") == 0


def test_killing_leaves_no_time_to_tidy_up(node: Node) -> None:
    process = start(stdout=subprocess.PIPE)
    time.sleep(1.0)
    os.kill(process.pid, signal.SIGKILL)
    out, _ = process.communicate()
    assert (process.returncode, out) == (-signal.SIGKILL, "counting\n")
    assert heard(node, 1.0) == []
    assert node.count_publishers("/numbers") == 1, "nobody has said that it is gone"
    time.sleep(20.0)
    assert node.count_publishers("/numbers") == 0, "its lease is over"


def test_a_node_can_be_restarted(node: Node) -> None:
    process = start()
    assert heard(node, 1.05)[-1] == 10
    process.terminate()
    process.wait()
    with start() as process:
        assert heard(node, 0.55)[-1] == 5
        process.kill()


@pytest.mark.usefixtures("node")
def test_waiting_for_a_process_may_time_out() -> None:
    process = start()
    before = time.monotonic()
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(timeout=2.5)
    assert time.monotonic() - before == pytest.approx(2.5, abs=0.01)


def test_other_programs_run_as_they_are() -> None:
    assert subprocess.run(["echo", "hello"], capture_output=True, text=True, check=True).stdout == "hello\n"
    assert subprocess.check_output([sys.executable, "-c", "print(6 * 7)"]) == b"42\n"


def test_what_starts_nodes_elsewhere_needs_real_ros() -> None:
    with pytest.raises(RuntimeError, match="needs real ROS: `ros2 run demo talker` starts nodes outside"):
        subprocess.Popen(["ros2", "run", "demo", "talker"])


def by_asyncio(command: str) -> None:
    asyncio.run(asyncio.create_subprocess_exec(*command.split()))


@pytest.mark.parametrize(
    "start_outside",
    [
        pytest.param(partial(subprocess.Popen, shell=True), id="shell"),
        pytest.param(lambda command: subprocess.Popen(["bash", "-c", f"cd .; {command}"]), id="bash"),
        pytest.param(lambda command: subprocess.Popen(["timeout", "5", *command.split()]), id="timeout"),
        pytest.param(lambda command: os.system(f"{command} &"), id="os.system"),
        pytest.param(by_asyncio, id="asyncio"),
    ],
)
def test_a_node_below_what_is_not_simulated_needs_real_ros(start_outside: Callable[[str], object]) -> None:
    with pytest.raises(RuntimeError, match=r"needs real ROS: `.*` starts nodes outside"):
        start_outside(f"{sys.executable} {COUNTER}")


def test_what_only_names_a_program_of_the_project_runs_as_it_is() -> None:
    for options in ({"args": ["cat", COUNTER]}, {"args": f"cat {COUNTER}", "shell": True}):
        assert "rclpy" in subprocess.run(**options, capture_output=True, text=True, check=True).stdout


def publish(queue: Any, count: int) -> None:
    """What a process of its own does."""
    rclpy.init()
    node = rclpy.create_node("publisher")
    publisher = node.create_publisher(Int32, "/numbers", 10)
    while not publisher.get_subscription_count():
        time.sleep(0.01)
    for number in range(count):
        publisher.publish(Int32(data=number))
    queue.put((multiprocessing.current_process().name, os.getpid()))
    rclpy.shutdown()


def test_multiprocessing_starts_processes_too(node: Node) -> None:
    queue: Any = multiprocessing.Queue()
    process = multiprocessing.Process(target=publish, args=(queue, 3), name="speaker")
    process.start()
    assert heard(node, 1.0) == [0, 1, 2]
    assert queue.get(timeout=1.0) == ("speaker", process.pid)
    process.join()
    assert process.exitcode == 0


@pytest.mark.parametrize("name", ["Pool", "Manager", "get_logger", "shared_memory"])
def test_what_multiprocessing_has_beside_processes_needs_real_ros(name: str) -> None:
    with pytest.raises(RuntimeError, match=f"needs real ROS: multiprocessing.{name} is not simulated"):
        getattr(multiprocessing, name)()


def test_what_multiprocessing_does_not_have_is_no_matter_of_ros() -> None:
    assert not hasattr(multiprocessing, "nothing")


def test_launch_needs_real_ros(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "site-packages" / "launch"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "actions.py").write_text("")
    monkeypatch.syspath_prepend(package.parent)
    with pytest.raises(RuntimeError, match="needs real ROS: the package launch starts nodes outside"):
        import launch.actions  # noqa: F401, PLC0415


def test_a_module_of_the_project_may_be_called_launch(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "launch.py").write_text("number = 3")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "launch", raising=False)
    import launch  # noqa: PLC0415

    assert launch.number == 3
