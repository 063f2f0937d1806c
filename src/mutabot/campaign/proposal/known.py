"""Vocabularies that mutabot ships and that fit the calls of a program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mutabot.model import Operation
from mutabot.vocabulary import load
from mutabot.vocabulary.load import shipped

from .layout import Layout, imported_modules
from .observed import SeenCall


@dataclass(frozen=True)
class Known:
    """A shipped vocabulary that describes calls of the program.

    Attributes:
        name: as the configuration names it.
        operations: its operations by target.
        tick: what its clock counts, or None.
        seen: how many of the callables that were seen it describes.
    """

    name: str
    operations: Mapping[str, Operation]
    tick: str | None
    seen: int

    def describes(self, call: SeenCall) -> bool:
        """Whether it has this callable, as an operation or as its clock."""
        return call.target in self.operations or call.target == self.tick

    def reads(self, call: SeenCall) -> bool:
        """Whether it has this callable as a reading."""
        operation = self.operations.get(call.target)
        return operation is not None and not operation.command


def known_vocabularies(layout: Layout, calls: Sequence[SeenCall]) -> list[Known]:
    """The shipped vocabularies with calls that were seen; without any calls, those that the text imports."""
    found = []
    imported = {name.partition(".")[0] for path in layout.program for name in imported_modules(path)}
    for name in shipped():
        vocabulary = load([name], layout.root)
        operations = {one.target: one for one in vocabulary.operations}
        seen = sum(call.target in operations for call in calls)
        packages = {target.partition(":")[0].partition(".")[0] for target in operations}
        if seen or (not calls and packages & imported):
            tick = vocabulary.clock.tick if vocabulary.clock is not None else None
            found.append(Known(name, operations, tick, seen))
    return found
