def gripper(robot):
    return robot.gripper
