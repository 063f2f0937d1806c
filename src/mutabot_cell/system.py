"""A robot system: an arm with its gripper and sensors, as a robot program uses them."""

from __future__ import annotations

from mutabot_cell.models.effectors import Fingers, SuctionCup
from mutabot_cell.models.noise import SeededNoise

from .arm import Arm
from .errors import BadArgument
from .force_sensor import ForceSensor
from .gripper import Gripper
from .robot import Robot
from .scene import Scene
from .sensors import Sensors
from .simulation import Simulation
from .six_joints import SixJointArm, SixJointSensors
from .suction import Suction


class RobotSystem:
    """One robot of a cell.

    Attributes:
        arm, sensors: as the robot program uses them.
        force_sensor: between the robot's flange and its tool.
        robot: in the physics.
        noise: of its sensors.
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
        self.robot, self.noise = robot, noise
        self.force_sensor = ForceSensor(simulation, robot, noise)
        has_six = len(robot.model.joints) == 6
        arm = SixJointArm if has_six else Arm
        self.arm = arm(simulation, robot, self.force_sensor)
        self._gripper: Gripper | None = None
        self._suction: Suction | None = None
        effector = None if robot.model.tool is None else robot.model.tool.effector
        if isinstance(effector, Fingers):
            self._gripper = Gripper(simulation, robot, effector, noise, grip_force, finger_speed)
        elif isinstance(effector, SuctionCup):
            self._suction = Suction(simulation, robot, effector, noise)
            self.arm.guard.explained.append(self._suction.arm_torque)
        sensors = SixJointSensors if has_six else Sensors
        self.sensors = sensors(simulation, robot, self.arm.kinematics, noise, scene, numbers)
        self._name = robot.model.name

    @property
    def gripper(self) -> Gripper:
        """The gripper.

        Raises:
            BadArgument: the robot has none.
        """
        if self._gripper is None:
            raise BadArgument(f"{self._name} has no gripper: give it one, RobotModel.with_tool(...)")
        return self._gripper

    @property
    def suction(self) -> Suction:
        """The suction cup.

        Raises:
            BadArgument: the robot has none.
        """
        if self._suction is None:
            raise BadArgument(
                f"{self._name} has no suction cup: give it one, RobotModel.with_tool(suction_cup(...))"
            )
        return self._suction

    def vacuum(self) -> float | None:
        """Return the exact vacuum in the suction cup, Pa below the atmosphere; None without one."""
        return None if self._suction is None else self._suction.true_vacuum()
