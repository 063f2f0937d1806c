"""Edits of `examples/ros2_docking` that take one guard away: then the order of things decides."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Race:
    """An edit of `docking.py`, and the order of callbacks that it does not stand."""

    before: str
    after: str
    fails_if: str


RACES = {
    "answer before the pose": Race(
        before="""\
        if answer.result().success:
            self._approach()
""",
        after="""\
        if answer.result().success:
            self.get_logger().info(f"the dock is {self._dock.pose.position.x} m ahead")
            self._become(State.APPROACHING)
""",
        fails_if="the answer of /dock/locate is taken before the message on /dock/pose",
    ),
    "question before the subscription": Race(
        before="can_hear = self._docks.get_publisher_count() > 0 and self._locate.service_is_ready()",
        after="can_hear = self._locate.service_is_ready()",
        fails_if="the station's publisher has not found the program's subscription when it answers",
    ),
}
