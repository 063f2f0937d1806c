"""MuJoCo work cells: robot, gripper, sensors, scene."""
