"""``mutabot results`` and ``show``: what the journal holds. Neither loads what runs a campaign."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

import typer

from mutabot.journal.files import find_journal

from . import options
from .output import print_json, show_results


def results(context: typer.Context, all: options.All = False, json: options.Json = False) -> None:
    """Show the results of the last campaign, also of one that was interrupted or still runs."""
    show_results(find_journal(context.obj), json=json, everything=all, earlier=True)


def show(
    context: typer.Context,
    mutant: options.OneMutant,
    json: options.Json = False,
) -> None:
    """Show everything about one mutant."""
    from mutabot.analysis.results import find_mutant, read_results
    from mutabot.analysis.stored.evidence import StoredEvidence
    from mutabot.analysis.suggested import kept_suggestions
    from mutabot.journal.reader import JournalReader
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.mutant.detail import print_mutant

    path = find_journal(context.obj)
    with JournalReader.open(path) as journal:
        found = read_results(journal, earlier=True)
        result = find_mutant(found, mutant)
        is_there = not result.outdated or result.mutant.family in found.meta.get("families", ())
        source = journal.source(result.mutant.site.span.file) if is_there else None
    if json:
        from mutabot.report.as_json import result_data

        print_json(result_data(result))
    else:
        with StoredEvidence(path) as evidence:
            suggestions = kept_suggestions(path, found.meta)
            print_mutant(make_console(), result, source, evidence, suggestions)
