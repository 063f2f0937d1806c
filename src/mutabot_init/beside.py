"""What packages beside this one add to the draft, from the same run of the tests, and projects to start from.

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
    """What a package watches and proposes."""

    def watch(self) -> Callable[[], Any]:
        """Watch this process, which has not imported the program yet.

        Returns a function that returns what was seen so far, as plain data.
        """

    def lines(self, seen: Sequence[Any]) -> list[str]:
        """The lines for the end of the configuration, from what each process saw, with a remark at first."""


def brought_proposers() -> dict[str, Proposer]:
    """The proposals of packages, by the packages' names; a package that cannot be used proposes nothing."""
    return _brought("PROPOSER")


def started(root: Path, files: Sequence[Path]) -> tuple[dict[str, str], list[str]] | None:
    """The project of the first package that has the language of these files, as ``Starter`` makes it."""
    starters: dict[str, Starter] = _brought("STARTER") if files else {}
    return next((made for one in starters.values() if (made := one(root, files)) is not None), None)


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
