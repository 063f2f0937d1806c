"""What mutabot is told of the topics of a simulator, by a node of the tests, in ROS 2."""

import threading

import numpy as np
from geometry_msgs.msg import PoseStamped
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import Image, JointState

from mutabot.api.processes import Feed


class Telling(Node):
    """Hears poses, joints and pictures, and tells the feed whenever a pose comes."""

    def __init__(self):
        super().__init__("telling")
        self.time, self.poses, self.fingers, self.picture = 0.0, {}, float("nan"), None
        self.feed = Feed(lambda: self.time)
        for name in ("tool", "box"):
            self.poses[name] = [float("nan")] * 7
            self.feed.pose(name, lambda name=name: self.poses[name])
            self.create_subscription(
                PoseStamped, f"/{name}/pose", lambda m, name=name: self.moved(name, m), 10
            )
        self.feed.value("fingers", lambda: self.fingers, unit="m")
        self.feed.camera(lambda: self.picture, rate=10)
        self.create_subscription(JointState, "/gripper/state", self.gripped, 10)
        self.create_subscription(Image, "/camera/image", self.seen, 1)

    def moved(self, name, message):
        place, turned = message.pose.position, message.pose.orientation
        self.poses[name] = [place.x, place.y, place.z, turned.w, turned.x, turned.y, turned.z]
        self.time = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
        self.feed.tick()

    def gripped(self, message):
        self.fingers = message.position[0]

    def seen(self, message):  # of the encoding rgb8
        rows = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
        self.picture = rows[:, : message.width * 3].reshape(message.height, message.width, 3)


def listen():
    """A node that listens in a thread of its own; call what it returns when the test is over."""
    node, executor = Telling(), SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()

    def stop():
        executor.shutdown()
        thread.join()
        node.destroy_node()

    return stop
