from robot import connect


def calibrate():
    link = connect()
    link.jog(0.02)
    link.zero()
    link.jog(-0.01)
    return link.read()
