"""The nodes of a test: the program's, and one that plays the base and the camera."""

import time

import rclpy
from geometry_msgs.msg import PointStamped, Twist
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from std_msgs.msg import String
from std_srvs.srv import SetBool

from program import LATCHED, Follower


class Scene:
    """Use as a context manager; parameters are those of the program's node."""

    def __init__(self, **parameters):
        rclpy.init(args=[])
        given = [Parameter(name, value=value) for name, value in parameters.items()]
        self.program = Follower(parameter_overrides=given)
        self.world = rclpy.create_node("world")
        self.place = self.world.create_publisher(PointStamped, "person/place", 10)
        self.ask = self.world.create_client(SetBool, "follower/follow")
        self.speeds, self.states = [], []
        self.world.create_subscription(Twist, "base/speed", self.on_speed, 10)
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.program)
        self.executor.add_node(self.world)
        self.spin(0.3)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.executor.shutdown()
        self.program.destroy_node()
        self.world.destroy_node()
        rclpy.try_shutdown()

    def on_speed(self, command):
        self.speeds.append((command.linear.x, command.angular.z))

    def listen(self):
        """Hear the states of the program from now on, and the last one before."""
        self.world.create_subscription(
            String, "follower/state", lambda state: self.states.append(state.data), LATCHED
        )
        self.spin(0.2)

    def seen(self):
        """What the world has got from the program."""
        return {"speeds": list(self.speeds), "states": list(self.states)}

    def spin(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.02)

    def follow(self, data=True):
        answer = self.ask.call_async(SetBool.Request(data=data))
        self.spin(0.05)
        return answer.result().success

    def see(self, x, y, seconds=0.3, frame="base", late=0.0):
        """Let the camera see the person there, ten times a second; what it says may be late."""
        for _ in range(round(seconds * 10)):
            place = PointStamped()
            place.header.frame_id = frame
            stamp = self.world.get_clock().now().nanoseconds - round(late * 1e9)
            place.header.stamp.sec, place.header.stamp.nanosec = divmod(stamp, 10**9)
            place.point.x, place.point.y = x, y
            self.place.publish(place)
            self.spin(0.1)
