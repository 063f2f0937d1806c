"""Hand-made recordings: a tool that carries a box for two seconds; the mutant lets it go after one."""

from __future__ import annotations

from array import array
from typing import Any

from mutabot.evidence.paths import RecordedPaths
from mutabot.evidence.recording import Block, RecordedCall, RecordedMoment, Recording, Track, TrackKind
from mutabot_motion.view import MotionView

STEPS = 21
TABLE = Block("the <table>", (0.5, 0.0, -0.05), (1.0, 1.0, 0.1), (0.5, 0.4, 0.3))
PLACE = "tests/test_box.py::test_arrives"


def recording(*, lets_go: bool = False, **changes: Any) -> Recording:
    times = array("d", (number / 10 for number in range(STEPS)))
    tool, box, opening, arm = array("f"), array("f"), array("f"), array("f")
    for number in range(STEPS):
        x, is_held = number / 20, not (lets_go and number > 10)
        tool.extend((x, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0))
        box.extend((x if is_held else 0.5, 0.0, 0.3 if is_held else 0.025))
        arm.extend((0.0, 0.0, 0.0, 0.0, 0.0, 0.5, x, 0.0, 0.3))
        opening.append(0.05 if is_held else 0.1)
    tracks = {
        "tool": Track("tool", TrackKind.POSE, tool),
        "a box": Track("a box", TrackKind.POINT, box, size=(0.05, 0.05, 0.05)),
        "opening": Track("opening", TrackKind.VALUE, opening, "m"),
        "arm": Track("arm", TrackKind.LINE, arm, radii=(0.05, 0.05, 0.04)),
    }
    calls = [
        RecordedCall(0.0, 2.0, "robot:Arm.move_by", "mission.py:3", None, {"dx": 1.0, "dy": 0}, {}),
        RecordedCall(2.0, 2.0, "robot:Camera.find", "tests/see.py:8", None, {}, {"x": 0.5}, "oracle"),
        RecordedCall(None, None, "robot:Arm.home", "mission.py:4", None, {}, {}),
    ]
    moments = [RecordedMoment(1.1, "part", "a box, fingers")] if lets_go else []
    found = Recording(times, tracks, (TABLE,), moments, calls)
    if lets_go:
        found.fault, found.faulty_call = 1.0, 1
    for name, value in changes.items():
        setattr(found, name, value)
    return found


def shown(**changes: Any) -> MotionView:
    values: dict[str, Any] = {
        "number": 7,
        "id": "mission.py:run:grip#1:call:skip",
        "what": "grip: do nothing → it opens",
        "place": "mission.py:3",
        "test": PLACE,
        "round": 1,
        "original": RecordedPaths(recording()),
        "mutant": RecordedPaths(recording(lets_go=True)),
        "story": "a box slipped from the fingers at 1.1 s",
        "apart": 1.1,
    }
    return MotionView(**{**values, **changes})
