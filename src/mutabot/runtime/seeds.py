"""Seeds: every (campaign seed, round, test) has its own, every (mutant, round, test) its own generator.

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

__all__ = ["derive", "seed_all", "seeded_apart"]


def seed_all(seed: int) -> None:
    """Seed ``random``, and numpy's global generator if numpy is loaded."""
    random.seed(seed)
    numpy_random = sys.modules.get("numpy.random")
    if numpy_random is not None:
        numpy_random.seed(seed)


@contextmanager
def seeded_apart(seed: int) -> Iterator[None]:
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
    """What pytest has given an id: a test, a file, a report about either."""

    @property
    def nodeid(self) -> str: ...


def node_id(named: PytestNode) -> str:
    """The id of a test. The name of its file need not be UTF-8, but what is written of it is."""
    return printable(named.nodeid)
