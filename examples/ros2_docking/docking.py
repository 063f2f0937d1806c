"""Drive a mobile robot onto its charging dock: a lifecycle node.

    python docking.py --ros-args -p approach_speed:=0.3

| what | name | type |
|---|---|---|
| the robot's speed | topic `/cmd_vel` | `geometry_msgs/Twist`, m/s and rad/s |
| where the robot is | topic `/robot/pose` | `geometry_msgs/PoseStamped`, frame `map` |
| where the dock is, said when it is asked | topic `/dock/pose` | `geometry_msgs/PoseStamped`, frame `map` |
| ask where the dock is | service `/dock/locate` | `std_srvs/Trigger` |
| make or break contact | service `/charger/connect` | `std_srvs/SetBool` |
| how far it got | topic `/docking/state`, latched | `std_msgs/String` |
| begin; stop where it is | services `/docking/dock`, `/docking/stop` | `std_srvs/Trigger` |
"""

from __future__ import annotations

import sys
from contextlib import suppress
from enum import Enum
from math import atan2, cos, hypot, pi, sin
from typing import Any

import rclpy
from geometry_msgs.msg import PoseStamped, Quaternion, Twist, Vector3
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

#: what was said last is kept for whoever comes later
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
#: seconds between two commands
PERIOD = 0.05
#: how near the dock is near enough for the contacts, in m
TOLERANCE = 0.015
#: beyond this angle to the dock the robot turns before it drives, in rad
WIDE = 0.35


class State(Enum):
    """How far the docking got."""

    IDLE = "idle"
    LOCATING = "locating"
    APPROACHING = "approaching"
    CONNECTING = "connecting"
    DOCKED = "docked"
    FAILED = "failed"
    STOPPED = "stopped"


class Docking(LifecycleNode):
    """Finds the dock, drives to it and makes contact."""

    def __init__(self, **options: Any) -> None:
        super().__init__("docking", **options)
        self.declare_parameter("approach_speed", 0.4)
        self.declare_parameter("slow_speed", 0.15)
        self.declare_parameter("slow_zone", 0.15)
        self.declare_parameter("patience", 0.6)
        self.declare_parameter("attempts", 2)
        self._state = State.IDLE
        self._robot: PoseStamped | None = None
        self._dock: PoseStamped | None = None
        self._asked: Future[Trigger.Response] | None = None
        self._attempts = 0

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Set up everything; nothing moves yet."""
        self._speed = self.create_lifecycle_publisher(Twist, "/cmd_vel", 10)
        self._told = self.create_publisher(String, "/docking/state", LATCHED)
        self._poses = self.create_subscription(PoseStamped, "/robot/pose", self.on_robot, 10)
        self._docks = self.create_subscription(PoseStamped, "/dock/pose", self.on_dock, 10)
        self._locate = self.create_client(Trigger, "/dock/locate")
        self._connect = self.create_client(SetBool, "/charger/connect")
        self._services = [
            self.create_service(Trigger, "/docking/dock", self.on_dock_asked),
            self.create_service(Trigger, "/docking/stop", self.on_stop_asked),
        ]
        self._control = self.create_timer(PERIOD, self.on_time, autostart=False)
        self._patience = self.create_timer(self._number("patience"), self.on_no_answer, autostart=False)
        self._become(State.IDLE)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Take commands from now on."""
        self._control.reset()
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stand still, and take no commands."""
        self._stand()
        self._control.cancel()
        self._patience.cancel()
        self._become(State.IDLE)
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Take down what was set up."""
        self.destroy_lifecycle_publisher(self._speed)
        self.destroy_publisher(self._told)
        for subscription in (self._poses, self._docks):
            self.destroy_subscription(subscription)
        for client in (self._locate, self._connect):
            self.destroy_client(client)
        for service in self._services:
            self.destroy_service(service)
        for timer in (self._control, self._patience):
            self.destroy_timer(timer)
        return super().on_cleanup(state)

    # what the robot is asked for

    def on_dock_asked(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Begin, unless it is under way or the node is not active."""
        if not self._speed.is_activated or self._state in (
            State.LOCATING,
            State.APPROACHING,
            State.CONNECTING,
        ):
            response.message = f"not now: {self._state.value}"
            return response
        self._dock = self._asked = None
        self._attempts = 0
        self._become(State.LOCATING)
        response.success = True
        return response

    def on_stop_asked(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Stand still where it is; a docked robot stays docked."""
        if self._state is not State.DOCKED:
            self._stand()
            self._patience.cancel()
            self._become(State.STOPPED)
        response.success = True
        return response

    # what it hears

    def on_robot(self, pose: PoseStamped) -> None:
        """Know where the robot is."""
        self._robot = pose

    def on_dock(self, pose: PoseStamped) -> None:
        """Know where the dock is, and go there."""
        self._dock = pose
        self._approach()

    def on_located(self, answer: Future[Trigger.Response]) -> None:
        """Fail if the dock is not to be found. The pose itself may have come before, or comes after this."""
        if self._state is not State.LOCATING or answer is not self._asked:
            return
        if answer.result().success:
            self._approach()
        else:
            self._become(State.FAILED)

    def on_connected(self, answer: Future[SetBool.Response]) -> None:
        """Count a yes whenever it comes, also after the time for it: the contacts are closed then."""
        if self._state in (State.CONNECTING, State.FAILED) and answer.result().success:
            self._patience.cancel()
            self._become(State.DOCKED)
        elif self._state is State.CONNECTING and answer is self._asked:
            self._patience.cancel()
            self._become(State.FAILED)

    def on_no_answer(self) -> None:
        """Ask the charger again, and give up after so many times."""
        self._patience.cancel()
        if self._state is State.CONNECTING and self._attempts < self.get_parameter("attempts").value:
            self._ask_for_contact()
        elif self._state is State.CONNECTING:
            self._become(State.FAILED)

    # what it does

    def on_time(self) -> None:
        """Do the next step of what is under way."""
        if self._state is State.LOCATING:
            self._ask_for_the_dock()
        elif self._state is State.APPROACHING and self._robot is not None:
            self._drive(self._robot)

    def _ask_for_the_dock(self) -> None:
        """Ask once, and not before the answer can be heard: the pose is not said twice."""
        can_hear = self._docks.get_publisher_count() > 0 and self._locate.service_is_ready()
        if self._asked is None and can_hear:
            self._asked = self._locate.call_async(Trigger.Request())
            self._asked.add_done_callback(self.on_located)

    def _approach(self) -> None:
        """Go on when the dock has said yes and where it is, in whatever order."""
        has_answer = self._asked is not None and self._asked.done()
        if self._state is State.LOCATING and has_answer and self._dock is not None:
            self._become(State.APPROACHING)

    def _drive(self, robot: PoseStamped) -> None:
        x = self._dock.pose.position.x - robot.pose.position.x
        y = self._dock.pose.position.y - robot.pose.position.y
        heading = yaw(robot.pose.orientation)
        ahead = x * cos(heading) + y * sin(heading)
        distance = hypot(x, y)
        if distance < TOLERANCE:
            self._stand()
            self._become(State.CONNECTING)
            self._ask_for_contact()
            return
        turn = wrapped(atan2(y, x) - heading)
        if distance < 4 * TOLERANCE:  # too near to aim
            turn = 0.0
        is_slow = distance < self._number("slow_zone")
        limit = self._number("slow_speed" if is_slow else "approach_speed")
        forward = 0.0 if abs(turn) > WIDE else max(-limit, min(limit, 2.0 * ahead))
        self._move(forward, max(-1.0, min(1.0, 2.0 * turn)))

    def _ask_for_contact(self) -> None:
        self._attempts += 1
        self._asked = self._connect.call_async(SetBool.Request(data=True))
        self._asked.add_done_callback(self.on_connected)
        self._patience.reset()

    def _stand(self) -> None:
        self._move(0.0, 0.0)

    def _move(self, forward: float, turn: float) -> None:
        self._speed.publish(Twist(linear=Vector3(x=forward), angular=Vector3(z=turn)))

    def _become(self, state: State) -> None:
        self._state = state
        self._told.publish(String(data=state.value))

    def _number(self, name: str) -> float:
        return float(self.get_parameter(name).value)


def yaw(orientation: Quaternion) -> float:
    """The angle about the vertical axis."""
    return 2 * atan2(orientation.z, orientation.w)


def wrapped(angle: float) -> float:
    """The same angle between -pi and pi."""
    return (angle + pi) % (2 * pi) - pi


def main() -> None:
    """Be the node, and be active, until somebody says that it is enough."""
    with suppress(KeyboardInterrupt, ExternalShutdownException), rclpy.init(args=sys.argv):
        node = Docking()
        node.trigger_configure()
        node.trigger_activate()
        rclpy.spin(node)


if __name__ == "__main__":
    main()
