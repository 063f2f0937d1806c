from robot import Arm


def go(x):
    arm = Arm()
    arm.move(abs(x))
    if x < 0:
        arm.grip(True)
    return arm


def rehearse(log, x):
    log.move(abs(x))
    log.grip(False)
    return str(log)
