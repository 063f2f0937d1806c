"""Models of the robot, the gripper, the whole cell in MuJoCo, and the noise of sensors."""
