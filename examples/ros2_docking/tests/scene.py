"""The nodes of a test in one process, and what a test asks the program for."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import TracebackType
from typing import Any

import rclpy
from docking import LATCHED, Docking
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from station import Robot, Station
from std_msgs.msg import String
from std_srvs.srv import Trigger

#: seconds after which a test gives up; docking takes two
PATIENCE = 15.0


class Scene:
    """A station, a watcher, and perhaps the program's node; all are spun by hand."""

    def __init__(self) -> None:
        rclpy.init(args=[])
        self.executor = SingleThreadedExecutor()
        self.station = Station(Robot())
        self.watcher = Node("watcher")
        self.docking: Docking | None = None
        self.states: list[str] = []
        self.watcher.create_subscription(
            String, "/docking/state", lambda state: self.states.append(state.data), LATCHED
        )
        self._dock = self.watcher.create_client(Trigger, "/docking/dock")
        self._stop = self.watcher.create_client(Trigger, "/docking/stop")
        self._nodes: list[Node] = [self.station, self.watcher]
        for node in self._nodes:
            self.executor.add_node(node)

    def __enter__(self) -> Scene:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.executor.shutdown()
        for node in self._nodes:
            node.destroy_node()
        rclpy.try_shutdown()

    def start(self, **options: Any) -> Docking:
        """Start the program's node in this process."""
        self.docking = Docking(**options)
        self._nodes.append(self.docking)
        self.executor.add_node(self.docking)
        self.docking.trigger_configure()
        self.docking.trigger_activate()
        return self.docking

    def until(self, is_so: Callable[[], Any], seconds: float = PATIENCE) -> bool:
        """Spin until something is so; false if it is not in so many seconds."""
        end = time.monotonic() + seconds
        while not is_so():
            if time.monotonic() > end:
                return False
            self.executor.spin_once(timeout_sec=0.02)
        return True

    def becomes(self, state: str) -> bool:
        """Whether the program says that it is in a state."""
        return self.until(lambda: self.states and self.states[-1] == state)

    def steps(self, count: int) -> None:
        """Let the robot do so many more steps."""
        wanted = len(self.station.robot.driven) + count
        assert self.until(lambda: len(self.station.robot.driven) >= wanted)

    def dock(self) -> bool:
        """Ask the program to dock; whether it begins."""
        return self._asked(self._dock)

    def stop(self) -> bool:
        """Ask the program to stop."""
        return self._asked(self._stop)

    def _asked(self, client: Any) -> bool:
        assert self.until(client.service_is_ready), f"{client.srv_name}: nobody offers it"
        answer = client.call_async(Trigger.Request())
        assert self.until(answer.done), f"{client.srv_name}: no answer"
        return bool(answer.result().success)
