"""Vocabularies that mutabot ships and that fit the calls of a program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mutabot.config.vocabulary import load
from mutabot.config.vocabulary.load import shipped
from mutabot.model import Operation

from .layout import Layout, imported_modules
from .observed import SeenCall

#: vocabularies of environments that are reached through the wrappers of another one
_BEHIND = {"metaworld": "gymnasium"}


@dataclass(frozen=True)
class Known:
    """A shipped vocabulary that describes calls of the program.

    Attributes:
        name: as the configuration names it.
        operations: its operations by target.
        tick: what its clock counts, or None.
        overridden: names of methods that it describes with all that override them.
        packages: where these may come from.
        seen: how many of the callables that were seen it describes.
    """

    name: str
    operations: Mapping[str, Operation]
    tick: str | None
    overridden: frozenset[str]
    packages: frozenset[str]
    seen: int = 0

    def describes(self, call: SeenCall) -> bool:
        """Whether it has this callable, as an operation or as its clock; wrappers and subclasses included."""
        alike = call.name in self.overridden and call.package in self.packages
        return alike or call.target in self.operations or call.target == self.tick

    def reads(self, call: SeenCall) -> bool:
        """Whether it has this callable as a reading."""
        operation = self.operations.get(call.target)
        return operation is not None and not operation.command


def known_vocabularies(layout: Layout, calls: Sequence[SeenCall]) -> list[Known]:
    """The shipped vocabularies with calls that were seen; without any calls, those that the text imports."""
    files = (*layout.program, *layout.tests)
    imported = {name.partition(".")[0] for path in files for name in imported_modules(path)}
    every = {name: _known(name, layout) for name in shipped()}
    for name, wrapper in _BEHIND.items():
        if name in imported:
            every[name] = _in_place_of(every[name], every.pop(wrapper))
    found = []
    for known in every.values():
        seen = sum(known.describes(call) for call in calls)
        if seen or (not calls and known.packages & imported):
            found.append(replace(known, seen=seen))
    return found


def _in_place_of(known: Known, wrapper: Known) -> Known:
    """A vocabulary that describes what the calls of another one lead to."""
    return replace(
        known,
        overridden=known.overridden | wrapper.overridden,
        packages=known.packages | wrapper.packages,
    )


def _known(name: str, layout: Layout) -> Known:
    vocabulary = load([name], layout.root)
    operations = {one.target: one for one in vocabulary.operations}
    tick = vocabulary.clock.tick if vocabulary.clock is not None else None
    overridden = frozenset(one.target.rpartition(".")[2] for one in vocabulary.operations if one.overrides)
    packages = frozenset(one.module.partition(".")[0] for one in vocabulary.operations)
    return Known(name, operations, tick, overridden, packages)
