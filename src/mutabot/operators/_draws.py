"""Common random numbers: what a call draws does not depend on how much other calls drew.

From a plain generator a program that makes one call more would shift all later draws. Two mutants that differ
in magnitude alone would then be two faults, and not one that is bigger.
"""

from __future__ import annotations

from random import Random

_BITS = 64


class Draws:
    """A generator for each hit of a site, in one test.

    Args:
        random: the mutant's generator for this round and test; one number is taken of it, now.
    """

    def __init__(self, random: Random) -> None:
        self._key = random.getrandbits(_BITS)
        self._hit = 0

    def next(self) -> Random:
        """The generator of the next hit. To be asked once at each hit, whatever becomes of it."""
        self._hit += 1
        return Random(f"{self._key}:{self._hit}")
