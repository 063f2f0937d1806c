"""The robot's driver as a node sees it, as thin as the maker's: topics and services of standard types.

| name | type | what it does |
|---|---|---|
| topic `/arm/move_by` | geometry_msgs/TwistStamped | straight-line move of the tool by m and rad |
| topic `/arm/wait` | std_msgs/Float64 | lets so many seconds pass before the next command |
| topic `/arm/ended` | actionlib_msgs/GoalStatus | a move or wait has ended: SUCCEEDED, REJECTED or ABORTED |
| service `/arm/home` | std_srvs/Trigger | joint move home; answers when it has ended |
| service `/gripper/close` | std_srvs/SetBool | starts closing (true) or opening (false) the fingers |

`connect` must be called before the first command, and after `rospy.init_node`.
"""

from __future__ import annotations

import math
from queue import Empty, Queue
from typing import Any

import rospy
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import TwistStamped
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, Trigger


class CommandFailed(Exception):  # noqa: N818  # as the driver says it
    """The driver did not do what it was told, or nothing was heard of it."""


class _Driver:
    """The connection to the driver node."""

    def __init__(self) -> None:
        self.patience = rospy.get_param("/arm/patience", 60.0)
        self._ended: Queue[GoalStatus] = Queue()
        self._stamp = 0
        rospy.Subscriber("/arm/ended", GoalStatus, self._ended.put)
        self.move = rospy.Publisher("/arm/move_by", TwistStamped, queue_size=10)
        self.wait = rospy.Publisher("/arm/wait", Float64, queue_size=10)
        self.home = rospy.ServiceProxy("/arm/home", Trigger)
        self.close = rospy.ServiceProxy("/gripper/close", SetBool)
        for service in (self.home, self.close):
            service.wait_for_service(self.patience)
        self._wait_for_subscribers()

    def next_stamp(self) -> rospy.Time:
        """Another one for each command, by which its end is known."""
        self._stamp += 1
        return rospy.Time(self._stamp)

    def wait_for_end(self, of: rospy.Time) -> None:
        """Wait until a command has ended.

        Raises:
            CommandFailed: the driver refused it or gave it up, or was not heard of in time.
        """
        while True:
            try:
                end = self._ended.get(timeout=self.patience)
            except Empty:
                raise CommandFailed(f"nothing heard of the command within {self.patience} s") from None
            if end.goal_id.stamp == of:
                break
        if end.status != GoalStatus.SUCCEEDED:
            raise CommandFailed(end.text)

    def _wait_for_subscribers(self) -> None:
        for _ in range(int(self.patience / 0.01)):
            if self.move.get_num_connections() and self.wait.get_num_connections():
                return
            rospy.rostime.wallsleep(0.01)
        raise CommandFailed("no driver has subscribed to the commands")


_driver: _Driver | None = None


def connect() -> None:
    """Find the driver node.

    Raises:
        CommandFailed: there is none.
    """
    global _driver  # noqa: PLW0603  (one robot per process, as with the maker's driver)
    _driver = _Driver()


def _connected() -> _Driver:
    if _driver is None:
        raise RuntimeError("no robot: call kinova.connect() first")
    return _driver


class Arm:
    """The arm. Lengths in m, angles in degrees, all in the base frame."""

    def home(self) -> None:
        """Joint move to the home position."""
        _check(_connected().home())

    def move_by(
        self,
        x: float = 0.0,
        y: float = 0.0,
        z: float = 0.0,
        theta_x: float = 0.0,
        theta_y: float = 0.0,
        theta_z: float = 0.0,
    ) -> None:
        """Straight-line move of the tool, relative to where it was last sent."""
        driver = _connected()
        message = TwistStamped()
        message.header.frame_id = "base"
        message.header.stamp = driver.next_stamp()
        linear, angular = message.twist.linear, message.twist.angular
        linear.x, linear.y, linear.z = x, y, z
        angular.x, angular.y, angular.z = (math.radians(angle) for angle in (theta_x, theta_y, theta_z))
        driver.move.publish(message)
        driver.wait_for_end(message.header.stamp)

    def wait(self, seconds: float) -> None:
        """Let time pass between two commands."""
        driver = _connected()
        driver.wait.publish(seconds)
        driver.wait_for_end(rospy.Time())


class Gripper:
    """The gripper."""

    def close(self, closed: bool) -> None:
        """Start closing the fingers, or opening them. Returns at once."""
        _check(_connected().close(closed))


def _check(answer: Any) -> None:
    if not answer.success:
        raise CommandFailed(answer.message)
