import robot
from robot import Arm


def fetch(distance, on_done):
    arm = Arm()
    arm.move_by(distance, speed=0.2)
    arm.grip(True)
    if arm.position() > 0.3:
        arm.move_by(-distance)
    on_done(distance)


def drop(arm):
    release = arm.grip
    release(False)
    arm.move_by(dx=0.05)
    return arm.position()


def tidy(steps):
    arm = robot.Arm()
    for step in steps:
        arm.move_by(step)
