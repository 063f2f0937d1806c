def load_part(robot):
    robot.move(x=0.5)
    robot.grip(True)
    robot.move(x=-0.25)


def unload_part(robot):
    robot.move(x=0.25)
    robot.grip(False)
    robot.move(x=-0.5)
