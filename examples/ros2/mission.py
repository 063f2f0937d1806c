"""Take the box from the conveyor and put it on the target table: further to the right if it is red.

A node of its own: python mission.py --ros-args -p use_sim_time:=true
"""

from __future__ import annotations

import sys
from math import radians

from kinova import Arm, ColorSensor, Gripper, connected, wait

OPEN = False
CLOSED = True


def run() -> None:
    """The whole mission, from home to home."""
    arm = Arm()
    gripper = Gripper()
    color_sensor = ColorSensor()

    # start
    gripper.command(OPEN)
    arm.home()

    # pick the box from the conveyor
    arm.move_by(y=0.2)
    arm.move_by(theta_x=radians(80))
    arm.move_by(z=-0.29)
    gripper.command(CLOSED)
    wait(1.5)
    arm.home()

    # carry it to the other side
    arm.move_by(theta_z=radians(80))
    arm.move_by(y=0.45)
    arm.move_by(x=-0.9)

    # place it by colour
    arm.move_by(theta_x=radians(80))
    arm.move_by(z=-0.3)
    if is_red(color_sensor.read()):
        arm.move_by(y=-0.2)
    gripper.command(OPEN)
    wait(1.0)
    arm.home()


def is_red(color: int) -> bool:
    """The sensor tells red by an even number."""
    return color % 2 == 0


if __name__ == "__main__":
    with connected("mission", sys.argv):
        run()
