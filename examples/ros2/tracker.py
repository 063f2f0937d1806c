"""What the test asks the measuring devices of the cell, over ROS."""

from __future__ import annotations

import time

import rclpy
from geometry_msgs.msg import Point, PointStamped
from kinova import LATCHED
from rclpy.client import Client
from rclpy.node import Node
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

#: wall-clock seconds
PATIENCE = 10.0

_node: Node | None = None
_clients: dict[str, Client] = {}


def connect(node: Node) -> None:
    """Let all readings be taken by this node."""
    global _node  # noqa: PLW0603  (one test at a time)
    _node = node
    for what in ("tool", "box"):
        _clients[what] = node.create_client(Trigger, f"/tracker/measure_{what}")


def robot_position() -> Point:
    """Measured tool position, base frame, m."""
    return _measured("tool")


def box_position() -> Point:
    """Measured middle of the box's bottom face, world frame, m."""
    return _measured("box")


def color() -> int:
    """The colour of this round's box: even is red, odd is blue."""
    return int(_latched("/color_sensor/number", Int32).data)


def _measured(what: str) -> Point:
    """Ask for a measurement, which is made after all that was asked for before, and wait for it."""
    node = _connected()
    client = _clients[what]
    end = time.monotonic() + PATIENCE
    while not client.service_is_ready():
        if time.monotonic() > end:
            raise TimeoutError(f"{client.srv_name}: nobody offers it")
        time.sleep(0.002)
    future = client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(node, future, timeout_sec=PATIENCE)
    if not future.done():
        raise TimeoutError(f"{client.srv_name}: no answer in {PATIENCE} s")
    if not future.result().success:
        raise LookupError(future.result().message)
    return _latched(f"/tracker/{what}", PointStamped).point


def _latched(topic: str, kind: type) -> object:
    found, message = wait_for_message(kind, _connected(), topic, qos_profile=LATCHED, time_to_wait=PATIENCE)
    if not found:
        raise TimeoutError(f"{topic}: nothing in {PATIENCE} s")
    return message


def _connected() -> Node:
    if _node is None:
        raise RuntimeError("no cell is running")
    return _node
