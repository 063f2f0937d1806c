"""``mutabot init``: a draft for a project that there is, or a project from a template."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from mutabot.api.reports import CommandContext

from .propose import propose
from .template import start


def init(
    context: CommandContext,
    program: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[PROGRAM]...", help="Files or folders of the robot program."),
    ] = None,
    template: tuple[str, Mapping[str, str]] | None = None,
) -> None:
    """Draft a configuration and a vocabulary from one run of the tests, or start a project."""
    if template is not None:
        lines = start(context.project, program or [], *template)
    else:
        lines = propose(context.project, program or [], tell=lambda text: context.tell([text]))
    for line in lines:
        context.print(line)
