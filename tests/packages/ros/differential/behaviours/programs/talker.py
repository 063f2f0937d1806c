"""A node that says a few numbers to whom it finds, and ends: python talker.py COUNT."""

from __future__ import annotations

import sys
import time

import rclpy
from rclpy.utilities import remove_ros_args
from std_msgs.msg import Int32


def main() -> int:
    """Be the node; gives the process's return code."""
    count = int(remove_ros_args(sys.argv)[1])
    with rclpy.init(args=sys.argv):
        node = rclpy.create_node("talker")
        publisher = node.create_publisher(Int32, "numbers", 10)
        end = time.monotonic() + 10
        while not publisher.get_subscription_count():
            if time.monotonic() > end:
                return 3
            time.sleep(0.01)
        for number in range(count):
            publisher.publish(Int32(data=number))
        publisher.wait_for_all_acked()
        print(f"{node.get_fully_qualified_name()} said {count}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
