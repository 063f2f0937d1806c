"""The additions of other packages to the draft, from the same test run, and the projects that they start.

The module that keeps a package's ``EXTENSION`` names these beside it, by reference: ``PROPOSER =
"module:name"`` an object that keeps ``Proposer``, ``STARTER = "module:name"`` a function as ``Starter``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, Protocol

#: makes a project of the files below its folder that are no Python: the texts of new files, by their paths
#: relative to the folder, with ``/``, and lines that say what was found out; None if it knows none of them
Starter = Callable[[Path, Sequence[Path]], tuple[dict[str, str], list[str]] | None]


class Proposer(Protocol):
    """Proposes lines for the configuration, from a package's own observations."""

    def watch(self) -> Callable[[], Any]:
        """Observe this process, which has not imported the program yet.

        Returns a function that returns what was seen so far, as plain data.
        """

    def lines(self, seen: Sequence[Any]) -> list[str]:
        """Return lines for the end of the configuration, after a comment, from what each process observed."""


def brought_proposers() -> dict[str, Proposer]:
    """Return the proposers of packages, by the packages' names; unusable packages propose nothing."""
    return _brought("PROPOSER")


def started(root: Path, files: Sequence[Path]) -> tuple[dict[str, str], list[str]] | None:
    """Return the project of the first package that knows these files' language, as ``Starter`` makes it."""
    starters: dict[str, Starter] = _brought("STARTER") if files else {}
    return next((made for starter in starters.values() if (made := starter(root, files)) is not None), None)


def _brought(kind: str) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for entry in entry_points(group="mutabot"):
        try:
            module, _, name = getattr(import_module(entry.module), kind, "").partition(":")
            if name:
                found[entry.name] = getattr(import_module(module), name)
        except Exception:  # commands that use such a package say what is wrong with it
            continue
    return found
