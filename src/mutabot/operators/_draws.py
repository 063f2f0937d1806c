"""Numbers drawn for one call, whatever other calls draw.

A draw is keyed by the mutant's own seed, in which are campaign, round, test and site, and by the number of
the call. From a stream a program that reads once more would shift all later draws, and one magnitude of a
fault could not be compared with another (common random numbers: L'Ecuyer 1994; keyed generators: Salmon et
al. 2011).
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random


def keyed(random: Random) -> Callable[[int], Random]:
    """What gives the generator of a call, by the call's number; ``random`` is the mutant's own."""
    key = random.getrandbits(64)
    return lambda number: Random(f"{key}:{number}")
