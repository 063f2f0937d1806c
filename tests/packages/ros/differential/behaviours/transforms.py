"""What a robot's programs do with transforms, without the library for them: topics with two qualities."""

from __future__ import annotations

from typing import Any

from builtin_interfaces.msg import Time as TimeMessage
from geometry_msgs.msg import TransformStamped, Vector3
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Header

from .declared import behaviour
from .graph import Graph, connect

STATIC = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def transform(parent: str, child: str, x: float, second: int = 0) -> TransformStamped:
    """A translation along x."""
    found = TransformStamped(
        header=Header(frame_id=parent, stamp=TimeMessage(sec=second)), child_frame_id=child
    )
    found.transform.translation = Vector3(x=x)
    found.transform.rotation.w = 1.0
    return found


class Buffer:
    """The latest transforms by child, and their sum to a root."""

    def __init__(self, node: Any) -> None:
        self.moving: dict[str, list[TransformStamped]] = {}
        node.create_subscription(TransformStamped, "/tf", self._hear, 100)
        node.create_subscription(TransformStamped, "/tf_static", self._hear, STATIC)

    def _hear(self, heard: TransformStamped) -> None:
        self.moving.setdefault(heard.child_frame_id, []).append(heard)

    def x(self, frame: str, root: str) -> float | None:
        """Where a frame is, seen from a root; None while that is not known."""
        place = 0.0
        while frame != root:
            if frame not in self.moving:
                return None
            latest = max(self.moving[frame], key=lambda stamped: stamped.header.stamp.sec)
            place += latest.transform.translation.x
            frame = latest.header.frame_id
        return place


@behaviour()
def a_late_listener_knows_the_static_transforms() -> Any:
    with Graph("broadcaster", "listener") as graph:
        broadcaster, listener = graph
        static = broadcaster.create_publisher(TransformStamped, "/tf_static", STATIC)
        for frame, parent, x in (("base", "map", 1.0), ("arm", "base", 0.25), ("tool", "arm", 0.5)):
            static.publish(transform(parent, frame, x))
        buffer = Buffer(listener)
        before = buffer.x("tool", "map")
        graph.until(lambda: buffer.x("tool", "map") is not None)
        return before, buffer.x("tool", "map"), sorted(buffer.moving)


@behaviour()
def a_moving_frame_under_a_static_one() -> Any:
    with Graph("broadcaster", "listener") as graph:
        broadcaster, listener = graph
        moving = broadcaster.create_publisher(TransformStamped, "/tf", 100)
        static = broadcaster.create_publisher(TransformStamped, "/tf_static", STATIC)
        static.publish(transform("base", "camera", 0.5))
        moving.publish(transform("map", "base", 9.0, second=1))
        buffer = Buffer(listener)
        connect(graph, moving)
        graph.spin()
        places = [buffer.x("camera", "map")]
        for second, x in ((2, 1.0), (4, 3.0), (3, 2.0)):
            moving.publish(transform("map", "base", x, second=second))
            graph.until(
                lambda second=second: any(
                    stamped.header.stamp.sec == second for stamped in buffer.moving.get("base", [])
                )
            )
            places.append(buffer.x("camera", "map"))
        return places
