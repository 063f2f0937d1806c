"""A node that counts: what the tests start as a process of its own."""

from __future__ import annotations

import sys
import threading
import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

ticks = 0


class Counter(Node):
    """Publishes numbers, ten a second, and tells on request how many."""

    def __init__(self) -> None:
        super().__init__("counter")
        self.declare_parameter("step", 1)
        self._numbers = self.create_publisher(Int32, "numbers", 10)
        self.create_service(Trigger, "~/how_many", self._tell)
        self.create_timer(0.1, self._tick)

    def _tick(self) -> None:
        global ticks  # noqa: PLW0603  (the tests look whether another process has a counter of its own)
        ticks += 1
        self._numbers.publish(Int32(data=ticks * self.get_parameter("step").value))

    def _tell(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success, response.message = True, f"{ticks} of {threading.current_thread().name}"
        return response


def main() -> None:
    """Count until somebody says that it is enough."""
    rclpy.init(args=sys.argv)
    node = Counter()
    print("counting", flush=True)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException) as error:
        print(type(error).__name__, flush=True)
        time.sleep(0.5)
    finally:
        print("tidied up", flush=True)
        rclpy.try_shutdown()
    sys.exit(3)


if __name__ == "__main__":
    main()
