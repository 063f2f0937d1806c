import robot
from robot import move_to, where


def weld(length):
    move_to(0.1, speed=0.5)
    robot.tool(True)
    move_to(0.1 + length)
    robot.tool(on=False)
    return where()
