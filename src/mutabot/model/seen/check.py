"""Checks that tests made and that held: what they compared, and how near they were to fail."""

from __future__ import annotations

from mutabot.frozen import frozen


@frozen
class Check:
    """One check of a test.

    Attributes:
        place: ``file:line`` of it.
        text: what the test says there.
        seen: the values that it compared; of a check that was made several times, those that were nearest to
            fail. Empty if they are no plain values.
        spare: how far the two sides of the comparison were apart, in their unit: by so much it held. None if
            it is no matter of more or less.
        times: how often it was made.
    """

    place: str
    text: str
    seen: str = ""
    spare: float | None = None
    times: int = 1


@frozen
class Looked:
    """A test that ran a mutant and passed.

    Attributes:
        test: node id.
        acted: whether the mutant changed something in it.
        checks: the checks that it made, in the order in which it made them first.
        more: how many further checks it made.
    """

    test: str
    acted: bool
    checks: tuple[Check, ...] = ()
    more: int = 0
