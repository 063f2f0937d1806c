"""Typing mistakes in ``--only`` and ``--skip`` that are seen without a plan, before the baseline."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from mutabot.campaign.faults.providers import operators_of_packages
from mutabot.errors import SelectionError
from mutabot.faults import known_families
from mutabot.languages.registry import program_files
from mutabot.model.mutant import Role, means_numbers
from mutabot.model.selection import nothing_fits
from mutabot.operators import registry

if TYPE_CHECKING:
    from mutabot.campaign.request import Request


def refuse_typos(request: Request) -> None:
    """Raise SelectionError for words that cannot fit a mutant of this project, whatever its plan is."""
    sources = (*request.configuration.program, *request.configuration.oracle)
    files = program_files(request.root, sources)
    names = [*registry.names(), *known_families(), *(role.value for role in Role)]
    mistakes = []
    for option, words in (("--only", request.only), ("--skip", request.skip)):
        if unknown := [word for word in words if not _may_fit(word, files, names)]:
            mistakes.append(str(nothing_fits(option, unknown, [*names, *operators_of_packages(), *files])))
    if mistakes:
        raise SelectionError("\n".join(mistakes))


def _may_fit(word: str, files: Sequence[str], names: Collection[str]) -> bool:
    """Whether there may be such a mutant. What holds wild signs, numbers or a list is for the plan to say."""
    file, colon, _ = word.partition(":")
    if means_numbers(word) or word.startswith("@") or {"*", "?"} & {*file}:
        return True
    if not colon and (word in names or word in operators_of_packages()):
        return True
    return any(_is_file(file, known) for known in files)


def _is_file(word: str, file: str) -> bool:
    """Whether a word is a file, its last part, or a folder above it."""
    return (
        word == file
        or file.endswith("/" + word.removeprefix("…/"))
        or file.startswith(word.rstrip("/") + "/")
    )
