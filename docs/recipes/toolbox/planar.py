"""A small toolbox of kinematics: a planar arm with two links. Lengths in metres, angles in radians."""

import numpy as np

UPPER, LOWER = 0.4, 0.3


def forward(joints):
    """Return the point of the tool, in metres."""
    first, second = joints
    both = first + second
    return np.array(
        [UPPER * np.cos(first) + LOWER * np.cos(both), UPPER * np.sin(first) + LOWER * np.sin(both)]
    )


def inverse(point):
    """Return the joint angles that put the tool at a point, in radians; the elbow stays below."""
    x, y = point
    cosine = (x**2 + y**2 - UPPER**2 - LOWER**2) / (2 * UPPER * LOWER)
    if abs(cosine) > 1:
        raise ValueError(f"({x:.3f}, {y:.3f}) m is out of reach")
    second = np.arccos(cosine)
    first = np.arctan2(y, x) - np.arctan2(LOWER * np.sin(second), UPPER + LOWER * np.cos(second))
    return np.array([first, second])


def joint_path(start, end, steps):
    """Return joint angles on the way from one configuration to another, one row per step."""
    return np.linspace(start, end, steps)
