"""``mutabot diff`` and ``mutabot export``: mutants of robot programs as differences of their text."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Annotated, TypedDict

import typer

from mutabot.api.faults import Project
from mutabot.api.processes import Request
from mutabot.api.reports import CommandContext, UsageError

from .planning import PlannedText, planned_texts
from .provider import variant_of
from .rules import BY_NAME, FAMILY

_Words = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="WORD", help="Only mutants in whose id all these words stand, such as a file's name."
    ),
]
_Folder = Annotated[Path, typer.Argument(metavar="DIR", help="The folder to write to; it must be empty.")]


class _Choice(TypedDict, total=False):
    """The options that these commands follow: they run nothing, and numbers are those of a plan."""

    family: Annotated[
        list[str] | None,
        typer.Option("--family", metavar="NAME", help="Families of mutants. Repeatable, or with commas."),
    ]
    settings: Annotated[
        list[str] | None,
        typer.Option("-o", metavar="KEY=VALUE", help="Set a key of the configuration for this command."),
    ]


def diff(context: CommandContext, request: Annotated[Request, _Choice], words: _Words = None) -> None:
    """Show mutants of robot programs as differences of their text.

    Each is what `patch` takes, below a comment with its id, in the encoding of its file.
    """
    for plan in _chosen(request, words):
        context.print(f"# {mutant_id(plan)}")
        for line in plan.program.diff(plan.difference):
            context.print_bytes(f"{line}\n".encode(plan.program.encoding))


def export(
    context: CommandContext, request: Annotated[Request, _Choice], folder: _Folder, words: _Words = None
) -> None:
    """Write mutated robot programs, a folder each, for the maker's own simulator.

    `mutants.json` in the folder says which mutant is in which folder.
    """
    if folder.exists() and any(folder.iterdir()):
        raise UsageError(f"{folder} is not empty: name a new folder")
    index: dict[str, str] = {}
    for number, plan in enumerate(_chosen(request, words), start=1):
        place = folder / str(number)
        for program in [plan.program, *plan.program.others]:
            target = place / program.file
            target.parent.mkdir(parents=True, exist_ok=True)
            is_changed = program is plan.program
            text = program.changed(plan.difference) if is_changed else program.text
            target.write_bytes(text.encode(program.encoding))
        index[str(number)] = mutant_id(plan)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "mutants.json").write_text(
        json.dumps(index, indent=1, ensure_ascii=False) + "\n", encoding="utf-8"
    )
    context.print(f"{len(index)} mutants in {folder}, each with all files of the program")


def mutant_id(plan: PlannedText) -> str:
    """Return the id of the mutant in campaigns."""
    variant = variant_of(plan.difference)
    return f"{plan.site.id}:{plan.difference.operator}{f'={variant}' if variant else ''}"


def _chosen(request: Request, words: list[str] | None) -> list[PlannedText]:
    files = Project(request.root, request.configuration.program).program_files()
    found = [plan for plan in planned_texts(request.root, files) if plan.difference.reason is None]
    if not words:
        found = [
            plan for plan in found if BY_NAME[plan.difference.operator].family in (FAMILY, *request.families)
        ]
    chosen = [plan for plan in found if all(_stands(word, mutant_id(plan)) for word in words or ())]
    if not chosen:
        what = f"with {' '.join(words)}" if words else "of these languages"
        raise UsageError(f"there is no mutant {what} in {', '.join(files) or 'the program'}")
    return chosen


def _stands(word: str, name: str) -> bool:
    return re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", name) is not None
