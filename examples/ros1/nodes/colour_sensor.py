"""The sensor that looks at the box on the conveyor: a node that publishes `/colour`, std_msgs/Int32.

A whole number from 1 to 10: even means the red box, odd the blue one. The box does not change its colour, so
it is published once and kept for whoever comes later.
"""

from __future__ import annotations

import rospy
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

if __name__ == "__main__":
    rospy.init_node("colour_sensor", disable_rosout=True)
    colour = rospy.Publisher("/colour", Int32, queue_size=1, latch=True)
    look = rospy.ServiceProxy("/cell/colour_number", Trigger)
    look.wait_for_service(30.0)
    colour.publish(int(look().message))
    rospy.spin()
