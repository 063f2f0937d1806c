"""A process that is forked in the middle of a graph goes on as its parent does."""

from __future__ import annotations

import json
import sys
import threading
import time
from typing import Any

import rclpy
from process_cases import start
from rclpy.executors import MultiThreadedExecutor
from std_msgs.msg import Int32

#: what Mutabot forks with; modules of the project have another one
os: Any = sys.modules["os"]


def test_a_fork_takes_threads_processes_and_time_along() -> None:
    process = start()
    with rclpy.init():
        nodes = [rclpy.create_node(f"node{number}") for number in range(2)]
        executor = MultiThreadedExecutor(2)
        heard: list[tuple[float, int]] = []
        for node in nodes:
            executor.add_node(node)
            node.create_subscription(
                Int32, "numbers", lambda message: heard.append((time.monotonic(), message.data)), 10
            )
        thread = threading.Thread(target=executor.spin, daemon=True)
        thread.start()
        time.sleep(1.0)
        heard.clear()
        receiving, sending = os.pipe()
        child = os.fork()
        time.sleep(2.0)
        process.terminate()
        story = [*heard, (time.monotonic(), process.wait())]
        executor.shutdown()
        thread.join()
        if not child:
            os.write(sending, json.dumps(story).encode())
            os._exit(0)
        os.close(sending)
        with os.fdopen(receiving) as told:
            assert json.load(told) == json.loads(json.dumps(story))
        assert os.waitpid(child, 0)[1] == 0
    assert len(heard) == 40
