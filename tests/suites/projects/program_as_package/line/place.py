from line.devices import gripper


def place(robot):
    robot.joints([1.0, 0.25, -0.25])
    gripper(robot).set(0)
