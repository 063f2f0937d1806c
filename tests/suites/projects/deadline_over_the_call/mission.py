import time


def pick(arm):
    arm.lift(0.2)
    time.sleep(0.4)
    arm.lift(-0.05)
