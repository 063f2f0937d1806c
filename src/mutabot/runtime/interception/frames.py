"""Tracebacks without frames of ours.

An exception keeps the frames that it came through, and these what a call was given: ours would keep it longer
than the robot's own do.
"""

from __future__ import annotations

from types import FrameType, TracebackType

from mutabot.extensions import GROUP
from mutabot.runtime.interception.trace import is_border


def without_ours(traceback: TracebackType | None) -> TracebackType | None:
    """Take the frames of ours out of a traceback: what is left is what the operation did itself.

    None of them may be running any more. The frames of the operation lead back to them: what they held is let
    go. What stands between the program and the operation is all ours, also what a package brought; in the
    operation, a package may have put a fault, which stays to be seen.
    """
    frames = []
    while traceback is not None:
        frames.append(traceback)
        traceback = traceback.tb_next
    callers = (number for number, one in enumerate(frames) if _is_caller(one.tb_frame))
    first, following = next(callers, -1), None
    for number, one in reversed(list(enumerate(frames))):
        if number <= first or _is_ours(one.tb_frame):
            one.tb_frame.clear()
        else:
            one.tb_next, following = following, one
    return following


def _is_caller(frame: FrameType) -> bool:
    """Whether it is the last of ours, which calls in the name of the program."""
    return is_border(frame.f_code) and not _is_ours(frame)


def _is_ours(frame: FrameType) -> bool:
    return str(frame.f_globals.get("__name__", "")).partition(".")[0] == GROUP
