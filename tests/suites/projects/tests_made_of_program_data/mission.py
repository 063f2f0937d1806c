import robot

ARM = robot.Arm()
ARM.move(2.0)
STATIONS = [("near", 0.5), ("far", ARM.where())]


def visit(x):
    ARM.home()
    ARM.move(x)
    return ARM.where()
