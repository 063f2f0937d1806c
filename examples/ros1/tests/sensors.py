"""What the test reads to judge the program: one function per occasion."""

from __future__ import annotations

import rospy
from geometry_msgs.msg import Point, PointStamped

PATIENCE = 10.0
"""How long to wait for a reading, s."""


def robot_home_position() -> Point:
    """Where the robot is before the program starts; base frame, m."""
    return rospy.wait_for_message("/tracker/robot", PointStamped, PATIENCE).point


def box_start_position() -> Point:
    """Where the box is before the program starts; world frame, m."""
    return rospy.wait_for_message("/tracker/box", PointStamped, PATIENCE).point


def box_end_position() -> Point:
    """Where the box is after the program; world frame, m."""
    return rospy.wait_for_message("/tracker/box", PointStamped, PATIENCE).point
