import robot


def prepare():
    robot.move(0.3)
    robot.grip(1)


def finish():
    robot.move(-0.1)
    robot.grip(0)
