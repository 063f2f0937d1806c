"""The robot's driver: a node around a simulated cell, with the topics and services that `kinova.py` lists.

Time passes in the cell only while it carries out a command: a run takes no longer than its physics, and its
end does not depend on how fast the nodes are. Commands are carried out one after another, as they come.

Beside the robot it publishes what the measuring devices of the test cell see, once after each command:
`/tracker/robot` (base frame) and `/tracker/box` (world frame), geometry_msgs/PointStamped, in m.

    python nodes/driver.py SEED          # of the round
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from queue import Empty, Queue
from threading import Event

import rospy
from actionlib_msgs.msg import GoalStatus
from geometry_msgs.msg import PointStamped, TwistStamped
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, SetBoolRequest, SetBoolResponse, Trigger, TriggerRequest, TriggerResponse

from mutabot_cell import Cell, Position
from mutabot_cell.errors import CellError, MotionRefused, SensorError

FRAME = "base"


class Driver:
    """The node.

    Args:
        cell: what stands behind it.
    """

    def __init__(self, cell: Cell) -> None:
        self._cell = cell
        self._commands: Queue[Callable[[], None]] = Queue()
        self._trackers = {
            name: rospy.Publisher(f"/tracker/{name}", PointStamped, queue_size=10, latch=True)
            for name in ("robot", "box")
        }
        self._ended = rospy.Publisher("/arm/ended", GoalStatus, queue_size=10)
        rospy.set_param("/cell/colour", cell.sensors.colour())
        self._tell()
        rospy.Subscriber("/arm/move_by", TwistStamped, self._on_move)
        rospy.Subscriber("/arm/wait", Float64, self._on_wait)
        rospy.Service("/cell/colour_number", Trigger, self._on_colour)
        rospy.Service("/gripper/close", SetBool, self._on_close)
        rospy.Service("/arm/home", Trigger, self._on_home)

    def spin(self) -> None:
        """Carry out commands until the node is shut down."""
        while not rospy.is_shutdown():
            try:
                command = self._commands.get(timeout=0.1)
            except Empty:
                continue
            command()

    def _on_move(self, message: TwistStamped) -> None:
        self._commands.put(lambda: self._end(message.header.stamp, lambda: self._move(message)))

    def _on_wait(self, message: Float64) -> None:
        self._commands.put(lambda: self._end(rospy.Time(), lambda: self._cell.wait(message.data)))

    def _on_close(self, request: SetBoolRequest) -> SetBoolResponse:
        return SetBoolResponse(*self._answer(lambda: self._cell.gripper.command(float(request.data))))

    def _on_home(self, request: TriggerRequest) -> TriggerResponse:
        return TriggerResponse(*self._answer(self._cell.arm.home))

    def _on_colour(self, request: TriggerRequest) -> TriggerResponse:
        return TriggerResponse(True, str(self._cell.sensors.colour_number()))

    def _move(self, message: TwistStamped) -> None:
        if message.header.frame_id != FRAME:
            raise MotionRefused(f"no frame {message.header.frame_id!r}", limit="frame")
        linear, angular = message.twist.linear, message.twist.angular
        angles = (math.degrees(angle) for angle in (angular.x, angular.y, angular.z))
        self._cell.arm.move_by(linear.x, linear.y, linear.z, *angles)

    def _end(self, stamp: rospy.Time, command: Callable[[], None]) -> None:
        """Carry out a command and say how it ended."""
        status = GoalStatus(status=GoalStatus.SUCCEEDED)
        status.goal_id.stamp = stamp
        try:
            command()
        except MotionRefused as error:
            status.status, status.text = GoalStatus.REJECTED, str(error)
        except CellError as error:
            status.status, status.text = GoalStatus.ABORTED, str(error)
        self._tell()
        self._ended.publish(status)

    def _answer(self, command: Callable[[], None]) -> tuple[bool, str]:
        """Let a command take its turn; whether it went well, and if not, why."""
        ended, why = Event(), [""]

        def turn() -> None:
            try:
                command()
            except CellError as error:
                why[0] = str(error)
            self._tell()
            ended.set()

        self._commands.put(turn)
        ended.wait()
        return not why[0], why[0]

    def _tell(self) -> None:
        """Publish what the measuring devices see."""
        sensors = self._cell.sensors
        self._publish("robot", FRAME, sensors.tool_pose().position)
        with suppress(SensorError):  # the camera does not see it: what it saw last stays latched
            self._publish("box", "world", sensors.box_position())

    def _publish(self, name: str, frame: str, position: Position) -> None:
        message = PointStamped()
        message.header.frame_id = frame
        message.header.stamp = rospy.Time.from_sec(self._cell.time)
        message.point.x, message.point.y, message.point.z = position.x, position.y, position.z
        self._trackers[name].publish(message)


if __name__ == "__main__":
    rospy.init_node("driver", disable_rosout=True)
    Driver(Cell(int(rospy.myargv()[1]))).spin()
