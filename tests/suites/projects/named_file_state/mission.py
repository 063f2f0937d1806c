"""The robot's position outlives the program: it is kept in a file of the project."""


def shuttle(arm):
    arm.move(4)
    arm.move(-1)
    arm.lamp(True)
