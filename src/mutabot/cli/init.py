"""``mutabot init`` and ``operators``: a first configuration and vocabulary, and the faults that there are."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from . import options
from .output import echo, print_json
from .request import families_of


def init(
    context: typer.Context,
    program: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[PROGRAM]...", help="Files or folders of the robot program."),
    ] = None,
) -> None:
    """Run the tests once, look at what the program calls, and propose a configuration and a vocabulary."""
    from mutabot.proposal import propose

    for line in propose(context.obj, program or [], tell=lambda text: typer.echo(text, err=True)):
        echo(line)


def operators(family: options.Families = None, json: options.Json = False) -> None:
    """List the operators: what each plants, where it applies, and which bugs it stands for."""
    from mutabot.campaign.plan.plan import listed_rules
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.listing import print_rules

    rules = [asdict(rule) for rule in listed_rules(families_of(family))]
    print_json({"operators": rules}) if json else print_rules(make_console(), rules)
