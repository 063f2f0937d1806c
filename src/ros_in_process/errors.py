"""The errors that the simulation raises, and the reasons why a run needs real ROS."""

from __future__ import annotations


class Deadlock(BaseException):
    """All threads wait, and no timer or message can wake any of them.

    Not an Exception, so that a program under test does not swallow it.
    """


class NeedsRealRos(RuntimeError):  # noqa: N818  (says what to do)
    """The simulation cannot do what was asked for; the message gives the reason.

    It says nothing about the program: the same may well work over real ROS.
    """

    def __init__(self, reason: str) -> None:
        super().__init__(f"needs real ROS: {reason}")
        note(reason)


#: why this run cannot be trusted without real ROS, in the order in which it was found
REASONS: list[str] = []


def note(reason: str) -> None:
    """Record once why this run cannot be trusted without real ROS, and continue."""
    if reason not in REASONS:
        REASONS.append(reason)
