"""Typing mistakes in ``--only`` and ``--skip`` that are seen without a plan: told before the baseline."""

from __future__ import annotations

import re
from functools import cached_property
from itertools import chain
from pathlib import Path

from mutabot.campaign.faults.providers import operators_of_packages
from mutabot.campaign.request import Request
from mutabot.errors import SelectionError
from mutabot.languages.registry import program_files
from mutabot.model.selector import line_of, means_numbers
from mutabot.model.site import Role
from mutabot.operators import registry
from mutabot.settings.families import known_families

from .selection import nothing_fits

_WILD = re.compile(r"[*?]")


def refuse_typos(request: Request) -> None:
    """Raises SelectionError for words that cannot fit a mutant of this project, whatever its plan is."""
    known = _Known(request)
    mistakes = [
        nothing_fits(option, unknown, known.words)
        for option, words in (("--only", request.only), ("--skip", request.skip))
        if (unknown := [word for word in words if not known.may_fit(word)])
    ]
    if mistakes:
        raise SelectionError(
            "\n".join(map(str, mistakes)),
            unknown=chain.from_iterable(mistake.unknown for mistake in mistakes),
        )


class _Known:
    """What mutants of a project can be named by, as far as it is known before the plan."""

    def __init__(self, request: Request) -> None:
        self._root = request.root
        configuration = request.configuration
        self._sources = (*configuration.program, *configuration.oracle)

    def may_fit(self, word: str) -> bool:
        """Whether there may be such a mutant. What holds wild signs or numbers is for the plan to say."""
        if means_numbers(word) or word.startswith("@"):  # what a list says is for the plan to say as well
            return True
        file, colon, _ = word.partition(":")
        if _WILD.search(file) or (not colon and (word in self._names or word in self._of_packages)):
            return True
        found = [known for known in self._files if _is_file(file, known)]
        line = line_of(word)
        if found and line is not None and _WILD.search(line[0]) is None:
            return any(line[1].start <= self._lines(known) for known in found)
        return bool(found) or _exists(self._root, file)

    @property
    def words(self) -> list[str]:
        """What may have been meant."""
        return [*self._names, *self._of_packages, *self._files]

    @cached_property
    def _names(self) -> tuple[str, ...]:
        return (*registry.names(), *known_families(), *(role.value for role in Role))

    @cached_property
    def _of_packages(self) -> tuple[str, ...]:
        """Operators that are none on calls; to look at them may take its time."""
        return tuple(operators_of_packages())

    @cached_property
    def _files(self) -> list[str]:
        return program_files(self._root, self._sources)

    def _lines(self, file: str) -> int:
        try:
            return (self._root / file).read_bytes().count(b"\n") + 1
        except OSError:
            return 0


def _is_file(word: str, file: str) -> bool:
    """Whether a word is a file, its last part, or a folder above it."""
    return (
        word == file
        or file.endswith("/" + word.removeprefix("…/"))
        or file.startswith(word.rstrip("/") + "/")
    )


def _exists(root: Path, file: str) -> bool:
    try:
        return bool(file) and (root / file).exists()
    except (OSError, ValueError):  # too long for a name, or with a zero in it
        return False
