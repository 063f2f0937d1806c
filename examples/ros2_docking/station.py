"""The world of the example as one node: a robot that drives, and a station with a dock and a charger."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import cos, hypot, sin
from typing import Any

from geometry_msgs.msg import PoseStamped, Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.timer import Timer
from std_msgs.msg import Header
from std_srvs.srv import SetBool, Trigger

#: seconds that pass with each step of the robot
STEP = 0.02
#: farther away the contacts do not meet, in m
REACH = 0.03


@dataclass
class Robot:
    """Where the robot is, what it does, and how fast it has been at each distance from the dock."""

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0
    forward: float = 0.0
    turn: float = 0.0
    driven: list[tuple[float, float]] = field(default_factory=list)


class Station(Node):
    """The robot drives as it was told last; the dock tells where it is when it is asked."""

    def __init__(self, robot: Robot, dock: tuple[float, float] = (0.35, 0.06), **options: Any) -> None:
        super().__init__("station", **options)
        self.robot = robot
        self.dock = dock
        #: whether the dock knows where it is, and whether the charger works
        self.is_there = True
        self.works = True
        #: seconds until the charger answers
        self.delay = 0.1
        self.charging = False
        self.asked_for_contact = 0
        self._pose = self.create_publisher(PoseStamped, "/robot/pose", 10)
        self._where = self.create_publisher(PoseStamped, "/dock/pose", 10)
        self.create_subscription(Twist, "/cmd_vel", self._command, 10)
        self.create_service(Trigger, "/dock/locate", self._locate)
        # a charger that takes its time holds nothing else up
        self.create_service(
            SetBool, "/charger/connect", self._connect, callback_group=ReentrantCallbackGroup()
        )
        self.create_timer(STEP, self._step)

    @property
    def gap(self) -> float:
        """How far the robot is from its place on the dock, in m."""
        return hypot(self.dock[0] - self.robot.x, self.dock[1] - self.robot.y)

    def _command(self, speed: Twist) -> None:
        self.robot.forward, self.robot.turn = speed.linear.x, speed.angular.z

    def _step(self) -> None:
        robot = self.robot
        robot.heading += robot.turn * STEP
        robot.x += robot.forward * STEP * cos(robot.heading)
        robot.y += robot.forward * STEP * sin(robot.heading)
        robot.driven.append((self.gap, robot.forward))
        self._pose.publish(self._placed(robot.x, robot.y, robot.heading))

    def _locate(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success = self.is_there
        if self.is_there:
            self._where.publish(self._placed(*self.dock, 0.0))
        return response

    async def _connect(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Close the contacts, which takes its time, or open them."""
        self.asked_for_contact += 1
        await self._pass(self.delay)
        if not request.data:
            self.charging = False
            response.success = True
        elif self.charging:
            response.message = "the contacts are closed"
        else:
            self.charging = response.success = self.works and self.gap <= REACH
        return response

    async def _pass(self, seconds: float) -> None:
        """Let time pass, and let others do their work meanwhile."""
        passed = self.executor.create_future()
        timers: list[Timer] = []

        def on_time() -> None:
            timers[0].cancel()
            passed.set_result(None)

        timers.append(self.create_timer(seconds, on_time))
        await passed
        self.destroy_timer(timers[0])

    def _placed(self, x: float, y: float, heading: float) -> PoseStamped:
        pose = PoseStamped(header=Header(frame_id="map", stamp=self.get_clock().now().to_msg()))
        pose.pose.position.x, pose.pose.position.y = x, y
        pose.pose.orientation.z, pose.pose.orientation.w = sin(heading / 2), cos(heading / 2)
        return pose
