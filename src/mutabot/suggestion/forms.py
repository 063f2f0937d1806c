"""In which form checks come: in the tests where they are, or in a test file of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Protocol

from mutabot.suggestion.choosing.checks import Check
from mutabot.suggestion.sources.project import Project
from mutabot.suggestion.sources.texts import changed_texts, import_blocks

from .styles.choice import insertions_of, style_of
from .styles.style import Written

#: what a new file says of itself
_HEAD = "Checks that mutabot suggests: each was run, and kills a fault that the other tests let through."


class Form(Protocol):
    """Puts checks into the project."""

    def texts(self, checks: Sequence[Check]) -> Mapping[str, str]:
        """The texts of the files that are new or changed, by their path in the project."""

    def tests(self, checks: Sequence[Check]) -> tuple[str, ...]:
        """The tests that make these checks, as arguments of pytest."""


@dataclass(frozen=True, slots=True)
class InPlace:
    """Checks at the ends of the tests that there are."""

    project: Project

    def texts(self, checks: Sequence[Check]) -> Mapping[str, str]:
        """As in ``Form``."""
        additions = [one.addition() for one in checks]
        return changed_texts(self.project.root, insertions_of(self.project, additions))

    def tests(self, checks: Sequence[Check]) -> tuple[str, ...]:
        """As in ``Form``."""
        return tuple(dict.fromkeys(one.place.node for one in checks))


@dataclass(frozen=True, slots=True)
class InFile:
    """Checks in a new test file, at the ends of copies of the tests that there are."""

    project: Project
    file: str

    def texts(self, checks: Sequence[Check]) -> Mapping[str, str]:
        """As in ``Form``."""
        written = [
            style_of(same[0].place).written(self.project, file, [one.addition() for one in same])
            for file, same in _by_file(checks).items()
        ]
        folder = PurePosixPath(self.file).parent
        further = {str(folder / name): text for one in written for name, text in one.files}
        return {self.file: _text_of(written), **further}

    def tests(self, checks: Sequence[Check]) -> tuple[str, ...]:
        """As in ``Form``."""
        return (self.file,)


def _by_file(checks: Sequence[Check]) -> dict[str, list[Check]]:
    found: dict[str, list[Check]] = {}
    for one in sorted(checks, key=lambda one: (one.place.file, one.place.style, one.place.node)):
        found.setdefault(one.place.file, []).append(one)
    return found


def _text_of(written: Sequence[Written]) -> str:
    blocks = import_blocks(line for one in written for line in one.imports)
    lines = [f'"""{_HEAD}"""', *(line for block in blocks for line in ("", *block))]
    for one in written:
        lines += one.lines
    return "\n".join(lines).rstrip("\n") + "\n"
