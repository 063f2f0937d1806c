from robot import POSITION


def calibrate(axis):
    axis.jog(-3.0)
    axis.jog(10.0)
    POSITION.write_text(str(axis.read()))


def back(axis):
    axis.jog(-float(POSITION.read_text()))
    return axis.read()
