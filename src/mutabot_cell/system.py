"""A robot system: an arm with its gripper and sensors, as a robot program uses them."""

from __future__ import annotations

from mutabot_cell.models.noise import SeededNoise

from .arm import Arm
from .errors import BadArgument
from .gripper import Gripper
from .robot import Robot
from .scene import Scene
from .sensors import Sensors
from .simulation import Simulation


class RobotSystem:
    """One robot of a cell.

    Attributes:
        arm, sensors: as the robot program uses them.
    """

    def __init__(
        self,
        simulation: Simulation,
        robot: Robot,
        noise: SeededNoise,
        scene: Scene,
        numbers: dict[str, int],
        *,
        grip_force: float | None,
        finger_speed: float | None,
    ) -> None:
        self.arm = Arm(simulation, robot)
        tool = robot.model.tool
        self._gripper = (
            None
            if tool is None
            else Gripper(simulation, robot, tool.effector, noise, grip_force, finger_speed)
        )
        self.sensors = Sensors(
            simulation, robot, self.arm.kinematics, noise, scene.boxes, numbers, scene.camera
        )
        self._name = robot.model.name

    @property
    def gripper(self) -> Gripper:
        """The gripper.

        Raises:
            BadArgument: the robot has no tool.
        """
        if self._gripper is None:
            raise BadArgument(f"{self._name} has no gripper: give it one, RobotModel.with_tool(...)")
        return self._gripper
