"""A node that adds its parameter to what it is asked, until somebody ends it; asked for -1 it fails."""

from __future__ import annotations

import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from test_msgs.srv import BasicTypes


class Adder(Node):
    """The node."""

    def __init__(self) -> None:
        super().__init__("adder")
        self.declare_parameter("offset", 1)
        self.asked = 0
        self.create_service(BasicTypes, "add", self.add)

    def add(self, request: BasicTypes.Request, response: BasicTypes.Response) -> BasicTypes.Response:
        """Answer the sum, and which request it was."""
        if request.int32_value == -1:
            raise ValueError("no")
        self.asked += 1
        response.int32_value = request.int32_value + self.get_parameter("offset").value
        response.int64_value = self.asked
        return response


def main() -> int:
    """Be the node; gives the process's return code."""
    try:
        with rclpy.init(args=sys.argv):
            rclpy.spin(Adder())
    except KeyboardInterrupt:
        return 11
    except ExternalShutdownException:
        return 12
    return 0


if __name__ == "__main__":
    sys.exit(main())
