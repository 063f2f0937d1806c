"""Seeds of each (campaign seed, round, test), and generators of each (mutant, round, test).

How tests are called: as pytest does, in texts that can be written down wherever they go.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Protocol

from mutabot.model.call import derive
from mutabot.model.codec import printable

__all__ = ["derive", "seed_all", "seeded_separately"]


def seed_all(seed: int) -> None:
    """Seed ``random``, and numpy's global generator if numpy is loaded."""
    random.seed(seed)
    numpy_random = sys.modules.get("numpy.random")
    if numpy_random is not None:
        numpy_random.seed(seed)


@contextmanager
def seeded_separately(seed: int) -> Iterator[None]:
    """Seed the generators for a block, and restore their states afterwards.

    Fixtures shared by several tests draw from their own seed: what they draw must not depend on which
    test happens to need them first.
    """
    before: Any = random.getstate()
    numpy_random = sys.modules.get("numpy.random")
    numpy_before: Any = numpy_random.get_state() if numpy_random is not None else None
    seed_all(seed)
    try:
        yield
    finally:
        random.setstate(before)
        if numpy_random is not None:
            numpy_random.set_state(numpy_before)


class PytestNode(Protocol):
    """An object of pytest with an id: a test, a file, or a report about either."""

    @property
    def nodeid(self) -> str: ...


def node_id(named: PytestNode) -> str:
    """Return the id of a test, with bytes of its file's name that are no UTF-8 escaped."""
    return printable(named.nodeid)
