"""``mutabot init``: drafts a configuration for an existing project, or starts one from a template."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from mutabot.api.reports import CommandContext

from .layout import other_files
from .propose import propose, refuse_existing
from .proposers import started
from .template import start


def init(
    context: CommandContext,
    program: Annotated[
        list[Path] | None,
        typer.Argument(metavar="PROGRAM", help="Files or folders of the robot program."),
    ] = None,
    template: tuple[str, Mapping[str, str]] | None = None,
) -> None:
    """Draft a configuration and a vocabulary from a run of the tests, or start a project.

    Robot programs in another language that have no tests get some, and a cell map.
    """
    if template is not None:
        lines = start(context.project, program or [], *template)
    elif (made := _started(context, program or [])) is not None:
        lines = made
    else:
        lines = propose(context.project, program or [], notify=lambda text: context.notify([text]))
    for line in lines:
        context.print(line)


def _started(context: CommandContext, program: list[Path]) -> list[str] | None:
    """Start a project for programs in a package's language; return None if there are none."""
    root = context.project.resolve()
    if not root.is_dir() or not (files := other_files(root, program)):
        return None
    made = started(root, files)
    if made is None:
        return None
    refuse_existing(root)
    texts, lines = made
    return [*lines, *start(root, (), "", texts)]
