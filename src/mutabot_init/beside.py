"""What packages beside this one watch in the same run of the tests, and add to the draft.

The module that keeps a package's ``EXTENSION`` names an object that keeps ``Proposer`` beside that, by
reference: ``PROPOSER = "module:name"``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any, Protocol


class Proposer(Protocol):
    """What a package watches and proposes."""

    def watch(self) -> Callable[[], Any]:
        """Watch this process, which has not imported the program yet.

        Returns a function that returns what was seen so far, as plain data.
        """

    def lines(self, seen: Sequence[Any]) -> list[str]:
        """The lines for the end of the configuration, from what each process saw, with a remark at first."""


def brought_proposers() -> dict[str, Proposer]:
    """The proposals of packages, by the packages' names; a package that cannot be used proposes nothing."""
    found: dict[str, Proposer] = {}
    for entry in entry_points(group="mutabot"):
        try:
            reference = getattr(import_module(entry.module), "PROPOSER", "")
            module, _, name = reference.partition(":")
            if name:
                found[entry.name] = getattr(import_module(module), name)
        except Exception:  # commands that use such a package say what is wrong with it
            continue
    return found
