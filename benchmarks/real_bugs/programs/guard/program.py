"""A node that slows a robot down, and stops it, when a laser scanner sees somebody near."""

import math

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float64
from std_srvs.srv import Trigger

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
#: m: nearer than that it stops, or is slow
STOP, SLOW = 0.5, 1.5
#: scans in a row that must agree before it stops
AGREEING = 2
#: seconds without a scan after which nothing is sure
SILENT = 0.5
#: per cent of the full speed
FULL, REDUCED = 100.0, 25.0


class Guard(Node):
    """The program."""

    def __init__(self, **options):
        super().__init__("guard", **options)
        self.declare_parameter("width", 120.0)
        self.limit = self.create_publisher(Float64, "robot/speed_limit", LATCHED)
        self.stopped = self.create_publisher(Bool, "guard/stopped", LATCHED)
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data)
        self.create_service(Trigger, "guard/reset", self.on_reset)
        self.watchdog = self.create_timer(SILENT, self.on_silence)
        self.near, self.nearest = 0, math.inf
        self.is_stopped = False
        self.told = None
        self.stopped.publish(Bool(data=False))

    def on_scan(self, scan):
        self.watchdog.reset()
        self.nearest = self.nearest_of(scan)
        self.near = self.near + 1 if self.nearest < STOP else 0
        if self.near >= AGREEING:
            self.stop()
        if not self.is_stopped:
            self.allow(REDUCED if self.nearest < SLOW else FULL)

    def nearest_of(self, scan):
        """The nearest valid range within the width that is watched, degrees about straight ahead."""
        half = math.radians(self.get_parameter("width").value) / 2
        found = math.inf
        for number, distance in enumerate(scan.ranges):
            angle = scan.angle_min + number * scan.angle_increment
            if abs(angle) <= half and scan.range_min <= distance <= scan.range_max:
                found = min(found, distance)
        return found

    def on_silence(self):
        self.stop()

    def on_reset(self, request, response):
        if self.nearest < STOP:
            response.success, response.message = False, "somebody is near"
            return response
        self.near = 0
        if self.is_stopped:
            self.is_stopped = False
            self.stopped.publish(Bool(data=False))
            self.allow(REDUCED)
        response.success = True
        return response

    def stop(self):
        if not self.is_stopped:
            self.is_stopped = True
            self.stopped.publish(Bool(data=True))
            self.allow(0.0)

    def allow(self, limit):
        if limit != self.told:
            self.limit.publish(Float64(data=limit))
            self.told = limit
