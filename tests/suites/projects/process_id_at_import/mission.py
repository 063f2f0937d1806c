import os


def who(arm):
    arm.grip(True)
    return os.getpid(), os.getppid()


def step(arm):
    arm.move(1.0)
    return arm.x
