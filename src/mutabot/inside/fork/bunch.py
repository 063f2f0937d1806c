"""Several mutants in one branch, as long as they behave alike.

Alternatives that give one value at their place leave the program in one state, so one process does for all of
them until the place is evaluated again and they differ.
"""

from __future__ import annotations

import mmap
import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from mutabot.model import Choice, Mutant

#: a mutant's place on the board: how its branch ended, and which test it is in, -1 before any
_CELL = struct.Struct("=Bxxxi")


class Board:
    """How far branches are and how they have ended, by mutant, in memory that they share with their trunk."""

    def __init__(self, mutants: Iterable[Mutant]) -> None:
        self._places = {mutant.id: place for place, mutant in enumerate(mutants)}
        self._memory = mmap.mmap(-1, max(1, len(self._places)) * _CELL.size)

    def begin(self, mutant: str, test: int) -> None:
        """A branch of it is about to begin, in this test by its number in the session; -1 before any."""
        self._write(mutant, 0, test)

    def note(self, mutant: str, code: int) -> None:
        """Its branch ends like this."""
        self._write(mutant, code, self.test(mutant))

    def next_test(self, mutant: str) -> None:
        """Its branch begins another test."""
        self._write(mutant, self.code(mutant), self.test(mutant) + 1)

    def code(self, mutant: str) -> int:
        """What was noted last; 0 if its branch has not said how it ended."""
        return self._cell(mutant)[0]

    def test(self, mutant: str) -> int:
        """The number of the test that its branch is in."""
        return self._cell(mutant)[1]

    def _cell(self, mutant: str) -> tuple[int, int]:
        code, test = _CELL.unpack_from(self._memory, self._places[mutant] * _CELL.size)
        return code, test

    def _write(self, mutant: str, code: int, tests: int) -> None:
        _CELL.pack_into(self._memory, self._places[mutant] * _CELL.size, code, tests)


@dataclass(slots=True)
class Bunch:
    """The mutants that a branch is.

    Attributes:
        mutants: those that have behaved alike until now; the first one stands for all.
        choices: their alternatives in the program text, by id.
        board: where to note how the branch ends.
        part: told a place, and the alternatives there, by the value that they have, that are about to differ
            from those of the first mutant: they go on in other processes.
        part_all: from here on each goes on in a process of its own.
        is_copied: whether the test has forked copies of this process, in which mutants may have differed.
        waited: seconds that this process has waited, in the running test, for those that parted.
        is_parting: whether it is about to fork for them.
    """

    mutants: list[Mutant]
    choices: Mapping[str, tuple[Choice, ...]]
    board: Board
    part: Callable[[int, Sequence[frozenset[int]]], None]
    part_all: Callable[[], None]
    is_copied: bool = False
    waited: float = 0.0
    is_parting: bool = False

    @property
    def first(self) -> Mutant:
        """The mutant that stands for all."""
        return self.mutants[0]

    @property
    def watched(self) -> dict[int, frozenset[int]]:
        """The alternatives that the others are, by place."""
        found: dict[int, set[int]] = {}
        for mutant in self.mutants[1:]:
            for choice in self.choices[mutant.id]:
                found.setdefault(choice.place, set()).add(choice.index)
        return {place: frozenset(indexes) for place, indexes in found.items()}

    def take_out(self, place: int, indexes: frozenset[int]) -> list[Mutant]:
        """The mutants but the first that are these alternatives; they are no longer of this bunch."""
        places = {Choice(place, index) for index in indexes}
        out = [one for one in self.mutants[1:] if not places.isdisjoint(self.choices[one.id])]
        self.mutants = [one for one in self.mutants if one not in out]
        return out

    def end(self, code: int) -> list[str]:
        """The branch ends like this; the ids of the mutants for which that holds."""
        for mutant in self.known:
            self.board.note(mutant, code)
        return self.known

    @property
    def known(self) -> list[str]:
        """The ids of the mutants for which holds what this process sees."""
        return [mutant.id for mutant in (self.mutants[:1] if self.is_copied else self.mutants)]

    @property
    def test(self) -> int:
        """The number of the test that the branch is in."""
        return self.board.test(self.first.id)

    def next_test(self) -> None:
        """The branch begins another test."""
        for mutant in self.mutants:
            self.board.next_test(mutant.id)
