"""A planar arm draws a line: a toolbox computes the joint angles, which are sent to the arm."""

import numpy as np
from planar import inverse, joint_path

STEPS = 20


def draw(arm, start, end):
    """Put the pen down at one point, draw to another one, and lift it."""
    follow(arm, joint_path(arm.joints(), inverse(start), STEPS))
    arm.pen(True)
    for point in np.linspace(start, end, STEPS):
        arm.servo(inverse(point))
    arm.pen(False)


def follow(arm, path):
    for joints in path:
        arm.servo(joints)
