"""A node that takes the box from the conveyor to the target table: further to the right if it is red."""

from __future__ import annotations

import rospy
from kinova import Arm, Gripper, connect
from std_msgs.msg import Int32

OPEN = False
CLOSED = True


def run() -> None:
    """The whole mission, from home to home."""
    arm = Arm()
    gripper = Gripper()

    # start
    gripper.close(OPEN)
    arm.home()

    # pick the box from the conveyor
    arm.move_by(y=0.2)
    arm.move_by(theta_x=80)
    arm.move_by(z=-0.29)
    gripper.close(CLOSED)
    arm.wait(1.5)
    arm.home()

    # carry it to the other side
    arm.move_by(theta_z=80)
    arm.move_by(y=0.45)
    arm.move_by(x=-0.9)

    # place it by colour
    arm.move_by(theta_x=80)
    arm.move_by(z=-0.3)
    color = rospy.wait_for_message("/colour", Int32, timeout=10.0)
    if is_red(color.data):
        arm.move_by(y=-0.2)
    gripper.close(OPEN)
    arm.wait(1)
    arm.home()


def is_red(color: int) -> bool:
    """The sensor tells red by an even number."""
    return color % 2 == 0


if __name__ == "__main__":
    rospy.init_node("mission", disable_rosout=True)
    connect()
    run()
