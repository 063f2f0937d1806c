"""The command ``accept``: survivors that may survive, each with a reason."""

from __future__ import annotations

import datetime
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Annotated

import typer
from typer import Option

from mutabot.campaign.suppressions import comments_in, line_at, note_accepted
from mutabot.cli.context import CommandContext
from mutabot.config.suppressions import FILE, add_acceptances, read_suppressions
from mutabot.errors import SelectionError, UsageError
from mutabot.journal.files import is_written
from mutabot.journal.journal import Journal
from mutabot.model.mutant_pattern import means_numbers, numbers_in
from mutabot.report.document import accepting_data
from mutabot.report.sections import Section, accepted_sections, numbered
from mutabot.report.terminal.console import make_console, print_section, short_place
from mutabot.report.texts import acceptance_text, state_of
from mutabot.results.results import MutantResult, Results

_MUTANTS = "Numbers (3,16-20), ids, or unique parts of ids. Without any, list what is accepted."
_WHY = "Why these may survive. It is written beside each of them."
_Mutants = Annotated[list[str] | None, typer.Argument(metavar="MUTANT", help=_MUTANTS)]
_Why = Annotated[str, Option("--why", metavar="TEXT", help=_WHY)]


def accept(context: CommandContext, mutant: _Mutants = None, why: _Why = "", json: bool = False) -> None:
    """Accept survivors, with a reason: they leave the list of survivors and the score.

    Writes mutabot-accepted.toml beside the configuration; commit it. Without a mutant, applies that file and
    the comments in the program to the last campaign, and lists what is accepted.
    """
    path = context.journal
    root, names = path.parent.parent, mutant or []
    if names and not why.strip():
        raise UsageError('say why these may survive: --why "…"')
    if why and not names:
        raise UsageError("--why needs a mutant: `mutabot accept 5 --why …`")
    results = context.results(earlier=True)
    chosen = list({result.mutant.id: result for result in _named(results, names)}.values())
    _refuse_others(chosen)
    read_suppressions(root)  # a file with a mistake is not added to
    if chosen:
        lines = cache(lambda file: (results.source(file) or "").split("\n"))
        entries = [(result.mutant.id, line_at(lines, result.mutant)) for result in chosen]
        add_acceptances(root, entries, why.strip(), datetime.date.today())
    if is_written(path):
        context.notify(
            [f"{FILE} is written; a campaign is running: `mutabot accept` applies it when that has ended"]
        )
        return
    _apply(path, root, results)
    found = context.results(earlier=True)
    if json:
        context.print_json(accepting_data(found))
        return
    shown = [*accepted_sections(found, short_place)] or [Section("No survivor is accepted")]
    for section in shown:
        print_section(make_console(), section)
    if chosen:
        context.notify([f"\naccepted {numbered([result.mutant.number for result in chosen])}; commit {FILE}"])


def _named(results: Results, names: Sequence[str]) -> Iterator[MutantResult]:
    """Yield the mutants that these words name, each of numbers such as ``3,16-20``. Raises SelectionError."""
    for name in names:
        for word in map(str, numbers_in(name)) if means_numbers(name) else [name]:
            yield results.mutant(word)


def _refuse_others(chosen: Sequence[MutantResult]) -> None:
    """Raise SelectionError for mutants that cannot be accepted."""
    wrong = []
    for result in chosen:
        name = f"mutant {result.mutant.number}"
        if result.is_accepted:
            source = result.acceptance and result.acceptance.source
            wrong.append(f"{name} was already {acceptance_text(result)} ({source})")
        elif result.mutant.has_sizes:
            wrong.append(f"{name} is a magnitude of a graded fault, which is in no score: nothing to accept")
        elif not result.is_survivor:
            wrong.append(f"{name} is not a survivor ({state_of(result)}): only survivors can be accepted")
    if wrong:
        raise SelectionError("\n".join(wrong))


def _apply(path: Path, root: Path, results: Results) -> None:
    """Update the journal's accepted mutants by the file and the program of its campaign."""
    suppressions = [*read_suppressions(root)]
    for file, text in results.sources.items():
        suppressions += comments_in(file, text)
    sources = {suppression.source for suppression in suppressions}
    unmatched = [place for place in results.accepting.unmatched if place.partition(": ")[0] in sources]
    with Journal.amend(path) as journal:
        note_accepted(journal, suppressions, unmatched)
