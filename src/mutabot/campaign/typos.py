"""Find typing mistakes in ``--only`` and ``--skip`` before the baseline, without a plan."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from mutabot.campaign.faults.providers import operators_of_packages, selected_providers
from mutabot.errors import SelectionError
from mutabot.faults import known_families
from mutabot.languages.registry import program_files
from mutabot.model.mutant import Role
from mutabot.model.mutant_pattern import lines_of_pattern, means_numbers
from mutabot.model.selection import nothing_fits
from mutabot.operators import registry

if TYPE_CHECKING:
    from pathlib import Path

    from mutabot.campaign.request import Request

_WILD = re.compile(r"[*?]")


def refuse_typos(request: Request) -> None:
    """Raise SelectionError for words that cannot match any mutant of this project.

    Where mutants may stand elsewhere than in the program, only the plan decides.
    """
    if not all(provider.in_program for provider in selected_providers(request.project)):
        return
    sources = (*request.configuration.program, *request.configuration.oracle)
    files = program_files(request.root, sources)
    names = [*registry.names(), *known_families(), *(role.value for role in Role)]
    mistakes = []
    for option, words in (("--only", request.only), ("--skip", request.skip)):
        if unknown := [word for word in words if not _may_fit(word, files, names, request.root)]:
            mistakes.append(str(nothing_fits(option, unknown, [*names, *operators_of_packages(), *files])))
    if mistakes:
        raise SelectionError("\n".join(mistakes))


def _may_fit(word: str, files: Sequence[str], names: Collection[str], root: Path) -> bool:
    """Return whether a mutant may match; numbers and lists are checked with the plan."""
    file, colon, _ = word.partition(":")
    if means_numbers(word) or word.startswith("@"):
        return True
    if wild := _WILD.search(file):  # ids and places begin with a file
        before = file[: wild.start()]
        return any(known.startswith(before) or before.startswith(known) for known in files)
    if not colon and (word in names or word in operators_of_packages()):
        return True
    meant = [known for known in files if _is_file(file, known)]
    lines = lines_of_pattern(word)
    return bool(meant) and (lines is None or any(lines[1].start <= _length(root / path) for path in meant))


def _length(file: Path) -> int:
    """Return the number of lines of a file."""
    return file.read_bytes().count(b"\n") + 1


def _is_file(word: str, file: str) -> bool:
    """Return whether a word is a file's name, its last part, or a folder above it."""
    return (
        word == file
        or file.endswith("/" + word.removeprefix("…/"))
        or file.startswith(word.rstrip("/") + "/")
    )
