"""Numbers drawn for one call, whatever other calls draw.

A draw is keyed by the mutant's own seed, in which are campaign, round, test and site, and by the number of
the call. From a stream a program that reads once more would shift all later draws, and one magnitude of a
fault could not be compared with another (common random numbers: L'Ecuyer 1994; keyed generators: Salmon et
al. 2011).
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
