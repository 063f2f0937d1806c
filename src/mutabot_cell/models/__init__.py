"""Models: of the robot, the gripper, the whole cell as MuJoCo wants it, and of the noise of sensors."""
