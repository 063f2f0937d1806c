"""What commands answer: noted in the baseline, and given while the robot does nothing."""

from __future__ import annotations

import copy
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from mutabot.model import Vocabulary
from mutabot.model.values.answer import NotKeptError, is_of_numpy, is_plain, keep

#: containers that a program may change after it got them
_CHANGEABLE = frozenset({list, dict, set, bytearray})


#: stands for an answer that cannot be kept and that the program waits for: it never comes
LOST = {"pending": ""}


@dataclass(frozen=True, slots=True)
class Returned:
    """What a call returned, and what it knew: the instance as ``self``, and the arguments.

    ``can_be_lost`` is whether the middleware knows what a program meets whose answer never comes.
    """

    value: Any
    here: Mapping[str, Any]
    can_be_lost: bool = False


@dataclass(slots=True)
class Answers:
    """The answers of the running test, for the trace.

    Plain values are noted as they are. Of others, the first at each site is noted by value, and later ones
    only by whether they are the same: what the robot answered first is all that is needed.

    Attributes:
        handles: classes that are part of the robot API.
    """

    handles: Collection[str] = ()
    _first: dict[int, Any] = field(default_factory=dict)
    _varying: set[int] = field(default_factory=set)

    @classmethod
    def of(cls, vocabulary: Vocabulary) -> Answers:
        """For this robot API."""
        return cls(handles_of(vocabulary))

    def start(self) -> None:
        """A new test begins."""
        self._first.clear()
        self._varying.clear()

    def note(self, site: int, returned: Returned | None) -> Any:
        """The note about an answer at a site; None for ``returned`` if the call raised."""
        if returned is None:
            return {"raised": True}
        if is_plain(returned.value):
            self._first.setdefault(site, returned.value)
            return returned.value
        if site in self._varying:
            return {"other": True}
        data = self._data(returned)
        if site not in self._first:
            self._first[site] = data
            return data
        if data == self._first[site] and "kept" in data:
            return {"same": True}
        self._varying.add(site)
        return {"other": True}

    def _data(self, returned: Returned) -> dict[str, Any]:
        try:
            return {"kept": keep(returned.value, returned.here, self.handles)}
        except NotKeptError as error:
            return {"kept": LOST} if returned.can_be_lost else {"opaque": str(error)}
        except Exception as error:  # objects of the user's may do anything when they are looked at
            return {"opaque": f"{type(returned.value).__qualname__}, which raises {error!r}"}


def handles_of(vocabulary: Vocabulary) -> frozenset[str]:
    """The classes that have operations as methods."""
    owners = (operation.target.rpartition(".")[0] for operation in vocabulary.operations)
    return frozenset(owner for owner in owners if ":" in owner)


def snapshot(value: Any) -> Any:
    """An answer as it is now: a program may change the list or array it got."""
    if type(value) in _CHANGEABLE or is_of_numpy(value):
        return copy.copy(value)
    return tuple(map(snapshot, value)) if type(value) is tuple else value
