"""``mutabot merge``: one journal of the journals of shards, judged like a run."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mutabot.cli import options
from mutabot.cli.output import decided, exit_as, show_results
from mutabot.exit_codes import ExitCode
from mutabot.journal.files import HOME, JOURNAL

if TYPE_CHECKING:
    from mutabot.analysis.gate import Decision
    from mutabot.analysis.results import Results
    from mutabot.settings.configuration import Configuration

_Journals = Annotated[
    list[Path], typer.Argument(metavar="JOURNAL", help="The shards' journals, or folders that hold one.")
]
_Output = Annotated[
    Path | None,
    typer.Option("--output", "-o", metavar="FILE", help="Where to write; else the project's journal."),
]


def merge(
    context: typer.Context,
    journals: _Journals,
    output: _Output = None,
    min_score: options.MinScore = None,
    json: options.Json = False,
) -> None:
    """Put the journals of shards together, and judge the campaign as `run` does.

    Exit code 4 if something is missing; what is there is written all the same.
    """
    from mutabot.campaign.sharding.merge import merge as put_together
    from mutabot.settings.configuration import load_configuration

    configuration = load_configuration(context.obj)
    target = output or configuration.root / HOME / JOURNAL
    missing = put_together(journals, target, root=configuration.root, room=configuration.evidence)
    results = show_results(target, json=json, summary=True)
    exit_as(_decision(configuration, results, min_score, missing))


def _decision(
    configuration: Configuration, results: Results, min_score: float | None, missing: list[str]
) -> Decision:
    from mutabot.analysis.gate import Decision

    if missing:
        return Decision(ExitCode.UNRELIABLE, tuple(missing))
    return decided(configuration, results, min_score)
