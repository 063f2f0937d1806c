"""``mutabot init``: a first configuration and vocabulary."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .output import echo


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
