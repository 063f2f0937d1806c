"""Several mutants in one branch, as long as they behave alike.

Alternatives that give one value at their place leave the program in one state, so one process does for all of
them until the place is evaluated again and they differ.
"""

from __future__ import annotations

import mmap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from mutabot.model import Choice, Mutant


class Board:
    """How branches have ended, by mutant, in memory that a trunk shares with all that is forked from it."""

    def __init__(self, mutants: Iterable[Mutant]) -> None:
        self._places = {mutant.id: place for place, mutant in enumerate(mutants)}
        self._memory = mmap.mmap(-1, max(1, len(self._places)))

    def note(self, mutant: str, code: int) -> None:
        """Its branch ends like this."""
        self._memory[self._places[mutant]] = code

    def clear(self, mutant: str) -> None:
        """A branch of it begins."""
        self.note(mutant, 0)

    def code(self, mutant: str) -> int:
        """What was noted last; 0 if its branch has not said how it ended."""
        return self._memory[self._places[mutant]]


@dataclass(slots=True)
class Bunch:
    """The mutants that a branch is.

    Attributes:
        mutants: those that have behaved alike until now; the first one stands for all.
        choices: their alternatives in the program text, by id.
        board: where to note how the branch ends.
        part: told a place, and the alternatives there, by the value that they have, that are about to differ
            from those of the first mutant: they go on in other processes.
        is_copied: whether the test has forked copies of this process, in which mutants may have differed.
        waited: seconds that this process has waited for those that parted.
    """

    mutants: list[Mutant]
    choices: Mapping[str, tuple[Choice, ...]]
    board: Board
    part: Callable[[int, Sequence[frozenset[int]]], None]
    is_copied: bool = False
    waited: float = 0.0

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
        known = self.mutants[:1] if self.is_copied else self.mutants
        for mutant in known:
            self.board.note(mutant.id, code)
        return [mutant.id for mutant in known]
