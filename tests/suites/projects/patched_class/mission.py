import robot
from robot import Gripper


def hold():
    gripper = Gripper("10.0.0.7")
    gripper.open_to(0.08)
    gripper.close()
    return gripper


def let_go():
    gripper = robot.Gripper(address="10.0.0.7")
    gripper.open_to(width=0.1)
    gripper.close()
