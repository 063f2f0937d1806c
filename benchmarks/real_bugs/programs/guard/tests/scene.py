"""The nodes of a test: the program's, and one that plays the scanner and the robot."""

import math
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float64
from std_srvs.srv import Trigger

from program import LATCHED, Guard


class Scene:
    """Use as a context manager; parameters are those of the program's node."""

    def __init__(self, **parameters):
        rclpy.init(args=[])
        given = [Parameter(name, value=value) for name, value in parameters.items()]
        self.program = Guard(parameter_overrides=given)
        self.world = rclpy.create_node("world")
        self.scanner = self.world.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self.ask = self.world.create_client(Trigger, "guard/reset")
        self.limits, self.stops = [], []
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.program)
        self.executor.add_node(self.world)
        self.spin(0.2)
        self.world.create_subscription(
            Float64, "robot/speed_limit", lambda limit: self.limits.append(limit.data), LATCHED
        )
        self.world.create_subscription(
            Bool, "guard/stopped", lambda stopped: self.stops.append(stopped.data), LATCHED
        )
        self.spin(0.1)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.executor.shutdown()
        self.program.destroy_node()
        self.world.destroy_node()
        rclpy.try_shutdown()

    def seen(self):
        """What the world has got from the program."""
        return {"limits": list(self.limits), "stops": list(self.stops)}

    def spin(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.02)

    def scan(self, *distances, at=0, times=3):
        """Scans 0.1 s apart, each with one distance at an angle in degrees, and 5 m at all others."""
        for distance in [one for one in distances for _ in range(times)]:
            scan = LaserScan(angle_min=-math.pi / 2, angle_max=math.pi / 2, angle_increment=math.pi / 36)
            scan.range_min, scan.range_max = 0.05, 10.0
            ranges = [5.0] * 37
            ranges[18 + at // 5] = distance
            scan.ranges = ranges
            self.scanner.publish(scan)
            self.spin(0.1)

    def reset(self):
        answer = self.ask.call_async(Trigger.Request())
        self.spin(0.05)
        return answer.result().success
