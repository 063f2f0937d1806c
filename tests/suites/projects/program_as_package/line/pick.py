from line import devices


def pick(robot):
    robot.joints([0.0, 0.5, -0.5])
    devices.gripper(robot).set(1)
    return devices.gripper(robot).feels()
