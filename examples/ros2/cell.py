"""The simulated cell as ROS 2 nodes: the robot's driver, the colour sensor, the tracker's measuring devices.

    python cell.py --seed 3

Simulated time passes only while a command is carried out or a wait is asked for, and `/clock` tells it. All
is done one after the other, in the order in which it came: what comes out does not depend on how busy the
machine is.
"""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable
from contextlib import suppress
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import rclpy
from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, PointStamped, PoseStamped, Quaternion, Twist
from kinova import ANSWERS, LATCHED
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64, Header, Int32
from std_srvs.srv import SetBool, Trigger

from mutabot_cell import Cell, CellError, MotionRefused, Pose, Position, SensorError

#: how often `/clock` speaks while time passes, in simulated seconds
CLOCK_PERIOD = 0.5


class Driver(Node):
    """The robot's driver; it also tells the time."""

    def __init__(self, cell: Cell) -> None:
        super().__init__("driver", enable_rosout=False, start_parameter_services=False)
        self._cell = cell
        self._clock_told = -math.inf
        self._clock_topic = self.create_publisher(Clock, "/clock", LATCHED)
        self._status = self.create_publisher(GoalStatus, "/arm/status", ANSWERS)
        self._pose = self.create_publisher(PoseStamped, "/arm/pose", LATCHED)
        self.create_subscription(Twist, "/arm/move_by", self._move_by, 10)
        self.create_subscription(Float64, "/cell/wait", self._wait, 10)
        self.create_service(Trigger, "/arm/home", self._home)
        self.create_service(SetBool, "/gripper/close", self._close)
        self.create_service(Trigger, "/cell/done", self._say_done)
        cell.simulation.before_tick.append(self._tick)
        self._tell()

    def _move_by(self, goal: Twist) -> None:
        lengths = (goal.linear.x, goal.linear.y, goal.linear.z)
        angles = (math.degrees(angle) for angle in (goal.angular.x, goal.angular.y, goal.angular.z))
        error = self._try(lambda: self._cell.arm.move_by(*lengths, *angles))
        status = GoalStatus(status=GoalStatus.STATUS_SUCCEEDED)
        if error is not None:
            is_refused = isinstance(error, MotionRefused)
            status.status = GoalStatus.STATUS_CANCELED if is_refused else GoalStatus.STATUS_ABORTED
        status.goal_info.stamp = stamp(self._cell)
        self._status.publish(status)

    def _home(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success, response.message = self._done(self._cell.arm.home)
        return response

    def _close(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        command = float(request.data)
        response.success, response.message = self._done(lambda: self._cell.gripper.command(command))
        return response

    def _say_done(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success = True
        return response

    def _wait(self, duration: Float64) -> None:
        self._try(lambda: self._cell.wait(duration.data))

    def _done(self, command: Callable[[], None]) -> tuple[bool, str]:
        """Carry out a command; says whether the robot did, and if not, why."""
        error = self._try(command)
        return error is None, str(error or "")

    def _try(self, command: Callable[[], None]) -> CellError | None:
        """Carry out a command, and say what the world is like then; gives what the robot has against it."""
        try:
            command()
        except CellError as error:
            return error
        finally:
            self._tell()
        return None

    def _tick(self) -> None:
        if self._cell.time >= self._clock_told + CLOCK_PERIOD:
            self._tell_time()

    def _tell(self) -> None:
        """Say what time it is and where the tool was sent."""
        self._tell_time()
        pose = self._cell.arm.commanded_pose()
        message = PoseStamped(header=Header(stamp=stamp(self._cell), frame_id="base"))
        message.pose.position = Point(x=pose.x, y=pose.y, z=pose.z)
        message.pose.orientation = quaternion(pose)
        self._pose.publish(message)

    def _tell_time(self) -> None:
        self._clock_told = self._cell.time
        self._clock_topic.publish(Clock(clock=stamp(self._cell)))


class ColorSensor(Node):
    """The sensor that looks at the box on the conveyor."""

    def __init__(self, cell: Cell) -> None:
        super().__init__("color_sensor", enable_rosout=False, start_parameter_services=False)
        publisher = self.create_publisher(Int32, "/color_sensor/number", LATCHED)
        publisher.publish(Int32(data=cell.sensors.colour_number()))


class Tracker(Node):
    """The robot's encoders and a camera above the cell; they measure when they are asked to."""

    def __init__(self, cell: Cell) -> None:
        super().__init__("tracker", enable_rosout=False, start_parameter_services=False)
        self._cell = cell
        self._tool = self.create_publisher(PointStamped, "/tracker/tool", LATCHED)
        self._box = self.create_publisher(PointStamped, "/tracker/box", LATCHED)
        self.create_service(Trigger, "/tracker/measure_tool", self._measure_tool)
        self.create_service(Trigger, "/tracker/measure_box", self._measure_box)

    def _measure_tool(self, request: Any, response: Trigger.Response) -> Trigger.Response:
        self._tool.publish(self._point(self._cell.sensors.tool_pose().position, "base"))
        response.success = True
        return response

    def _measure_box(self, request: Any, response: Trigger.Response) -> Trigger.Response:
        try:
            self._box.publish(self._point(self._cell.sensors.box_position(), "world"))
            response.success = True
        except SensorError as error:
            response.message = str(error)
        return response

    def _point(self, place: Position, frame: str) -> PointStamped:
        header = Header(stamp=stamp(self._cell), frame_id=frame)
        return PointStamped(header=header, point=Point(x=place.x, y=place.y, z=place.z))


def stamp(cell: Cell) -> Time:
    """The cell's time."""
    seconds = round(cell.time, 9)
    return Time(sec=int(seconds), nanosec=round(seconds % 1 * 1e9))


def quaternion(pose: Pose) -> Quaternion:
    """The orientation of a pose."""
    half = [math.radians(angle) / 2 for angle in (pose.theta_x, pose.theta_y, pose.theta_z)]
    (cx, cy, cz), (sx, sy, sz) = map(math.cos, half), map(math.sin, half)
    return Quaternion(
        w=cx * cy * cz + sx * sy * sz,
        x=sx * cy * cz - cx * sy * sz,
        y=cx * sy * cz + sx * cy * sz,
        z=cx * cy * sz - sx * sy * cz,
    )


def main() -> None:
    """Be the cell's nodes until somebody says that it is enough."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seed", type=int, default=0)
    seed = parser.parse_args().seed
    cell = Cell(seed)
    rclpy.init()
    executor = SingleThreadedExecutor()
    nodes = [Driver(cell), ColorSensor(cell), Tracker(cell)]
    for node in nodes:
        executor.add_node(node)
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()
    for node in nodes:
        node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
