"""The robot's client for ROS 2, as thin as the maker's: what `mission.py` is written against.

| what | name | type |
|---|---|---|
| a straight-line move, relative | topic `/arm/move_by` | `geometry_msgs/Twist`, m and rad |
| how it ended | topic `/arm/status` | `action_msgs/GoalStatus`: 4 done, 5 refused, 6 stopped half-way |
| a joint move home | service `/arm/home` | `std_srvs/Trigger` |
| the gripper | service `/gripper/close` | `std_srvs/SetBool` |
| the colour | topic `/color_sensor/number`, latched | `std_msgs/Int32` |
| whether all that was asked for is done | service `/cell/done` | `std_srvs/Trigger` |
| let time pass | topic `/cell/wait` | `std_msgs/Float64`, s; `/clock` says when it has |
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import rclpy
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Twist, Vector3
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import Float64, Int32
from std_srvs.srv import SetBool, Trigger

#: what was said last is kept for whoever comes later
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
#: the same, for what must not get lost: one answer after the other
ANSWERS = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
#: wall-clock seconds after which one may ask whether an answer is still to come; a move takes 0.02
PATIENCE = 1.0
#: the same for a cell that is not there
LONG_PATIENCE = 10.0

_node: Node | None = None


class Refused(Exception):  # noqa: N818  (says what happened)
    """The robot did not do as it was told."""


class NoAnswer(Exception):  # noqa: N818  (as above)
    """No answer will come any more."""


@contextmanager
def connected(name: str, args: list[str]) -> Iterator[Node]:
    """Be a node of this name, as a robot program is, until the block ends."""
    global _node  # noqa: PLW0603  (one robot per process, as with the maker's client)
    rclpy.init(args=args)
    _node = Node(name, enable_rosout=False, start_parameter_services=False)
    try:
        yield _node
    finally:
        _node.destroy_node()
        _node = None
        rclpy.try_shutdown()


def _connected() -> Node:
    if _node is None:
        raise RuntimeError("no robot: use `with kinova.connected(name, args)`")
    return _node


def _until(is_so: Callable[[], Any], what: str) -> None:
    """Spin the node until something is so.

    The cell does one thing after the other. So if it answers a question that came later, and not this one, it
    has never heard of it; how busy the machine is does not matter.
    """
    if not _spin(is_so, PATIENCE):
        future = _cell_is_done(what)
        if not _spin(future.done, LONG_PATIENCE) or not _spin(is_so, PATIENCE):
            raise NoAnswer(f"{what}: no answer")


def _cell_is_done(what: str) -> Any:
    """Ask for an answer that comes when all that was asked for before is done."""
    client = _connected().create_client(Trigger, "/cell/done")
    if not _spin(client.service_is_ready, LONG_PATIENCE):
        raise NoAnswer(f"{what}: no cell is there")
    return client.call_async(Trigger.Request())


def _spin(is_so: Callable[[], Any], seconds: float) -> bool:
    """Spin the node until something is so; false if it is not in so many wall-clock seconds."""
    end = time.monotonic() + seconds
    while not is_so():
        if time.monotonic() > end:
            return False
        rclpy.spin_once(_connected(), timeout_sec=0.005)
    return True


def _asked(client: Any, request: Any) -> None:
    """Call a service, and raise if its answer is no."""
    _until(client.service_is_ready, client.srv_name)
    future = client.call_async(request)
    _until(future.done, client.srv_name)
    answer = future.result()
    if not answer.success:
        raise Refused(answer.message)


class Arm:
    """The arm. Lengths in m, angles in rad, all in the base frame."""

    def __init__(self) -> None:
        node = _connected()
        self._home = node.create_client(Trigger, "/arm/home")
        self._move_by = node.create_publisher(Twist, "/arm/move_by", 10)
        self._answers: list[GoalStatus] = []
        node.create_subscription(GoalStatus, "/arm/status", self._answers.append, ANSWERS)

    def home(self) -> None:
        """Joint move to the home position."""
        _asked(self._home, Trigger.Request())

    def move_by(
        self,
        x: float = 0.0,
        y: float = 0.0,
        z: float = 0.0,
        theta_x: float = 0.0,
        theta_y: float = 0.0,
        theta_z: float = 0.0,
    ) -> None:
        """Straight-line move of the tool, relative to where it was last sent; returns when it has ended."""
        _until(self._move_by.get_subscription_count, "/arm/move_by")
        goal = Twist(linear=Vector3(x=x, y=y, z=z), angular=Vector3(x=theta_x, y=theta_y, z=theta_z))
        self._move_by.publish(goal)
        _until(lambda: self._answers, "/arm/status")
        status = self._answers.pop(0).status
        if status != GoalStatus.STATUS_SUCCEEDED:
            raise Refused(f"the arm ended a move with status {status}")


class Gripper:
    """The gripper."""

    def __init__(self) -> None:
        self._close = _connected().create_client(SetBool, "/gripper/close")

    def command(self, closed: bool) -> None:
        """Start moving the fingers. Returns at once."""
        _asked(self._close, SetBool.Request(data=closed))


class ColorSensor:
    """The sensor that looks at the box on the conveyor."""

    def read(self) -> int:
        """A whole number from 1 to 10: even means the red box, odd the blue one."""
        found, message = wait_for_message(
            Int32, _connected(), "/color_sensor/number", qos_profile=LATCHED, time_to_wait=LONG_PATIENCE
        )
        if not found:
            raise NoAnswer(f"/color_sensor/number: nothing in {LONG_PATIENCE} s")
        return int(message.data)


def wait(seconds: float) -> None:
    """Wait in the robot's time, which passes only when it is asked for."""
    node = _connected()
    publisher = node.create_publisher(Float64, "/cell/wait", 10)
    clock = node.get_clock()
    _until(publisher.get_subscription_count, "/cell/wait")
    _until(lambda: clock.now().nanoseconds, "/clock")
    end = clock.now() + Duration(seconds=seconds)
    publisher.publish(Float64(data=seconds))
    _until(lambda: clock.now() >= end, "/clock")
    node.destroy_publisher(publisher)
