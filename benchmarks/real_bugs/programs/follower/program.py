"""A node that lets a base follow a person at a distance."""

import math

from geometry_msgs.msg import PointStamped, Twist
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import SetBool

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
PERIOD = 0.1
#: seconds after which nobody knows where the person is
TOO_OLD = 0.5
#: rad, beside which the base turns on the spot
ASIDE = 0.6


class Follower(Node):
    """The program."""

    def __init__(self, **options):
        super().__init__("follower", **options)
        self.declare_parameter("distance", 1.0)
        self.declare_parameter("top_speed", 0.5)
        self.speed = self.create_publisher(Twist, "base/speed", 10)
        self.state = self.create_publisher(String, "follower/state", LATCHED)
        self.create_subscription(PointStamped, "person/place", self.on_person, 10)
        self.create_service(SetBool, "follower/follow", self.on_follow)
        self.create_timer(PERIOD, self.on_time)
        self.person = None
        self.told = ""
        self.following = False
        self.tell("idle")

    def on_person(self, place):
        """Where the person is, in the base's frame: x ahead, y to the left."""
        if place.header.frame_id == "base":
            self.person = place

    def on_follow(self, request, response):
        self.following = request.data
        if not self.following:
            self.person = None
            self.drive(0.0, 0.0)
            self.tell("idle")
        response.success = True
        return response

    def on_time(self):
        if not self.following:
            return
        if self.person is None or self.age() > TOO_OLD:
            self.drive(0.0, 0.0)
            self.tell("lost")
            return
        ahead, left = self.person.point.x, self.person.point.y
        turn = math.atan2(left, ahead)
        gap = math.hypot(ahead, left) - self.number("distance")
        forward = 0.0 if abs(turn) > ASIDE else 0.8 * gap
        top = self.number("top_speed")
        self.drive(max(-top, min(forward, top)), max(-1.0, min(2.0 * turn, 1.0)))
        self.tell("following")

    def age(self):
        stamp = self.person.header.stamp
        return self.get_clock().now().nanoseconds * 1e-9 - (stamp.sec + stamp.nanosec * 1e-9)

    def drive(self, forward, turn):
        command = Twist()
        command.linear.x, command.angular.z = forward, turn
        self.speed.publish(command)

    def tell(self, state):
        if state != self.told:
            self.state.publish(String(data=state))
            self.told = state

    def number(self, name):
        return self.get_parameter(name).value
