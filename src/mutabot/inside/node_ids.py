"""How tests are called: as pytest does, in texts that can be written down wherever they go."""

from __future__ import annotations

from typing import Protocol

from mutabot.border.storable import printable


class Named(Protocol):
    """What pytest has given an id: a test, a file, a report about either."""

    @property
    def nodeid(self) -> str: ...


def node_id(named: Named) -> str:
    """The id of a test. The name of its file need not be UTF-8, but what is written of it is."""
    return printable(named.nodeid)
