"""``mutabot patches``: writes the reverted fixes of a repository's history as patches."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mutabot.api.reports import CommandContext, UsageError

from .extension import FAMILY
from .history import FIXES, Reverted, reverted

_PatchPaths = Annotated[
    list[str] | None, typer.Argument(metavar="[PATH]...", help="Files and folders of the program; else all.")
]
_FromGit = Annotated[
    str, typer.Option("--from-git", metavar="A..B", help="The commits to look at, as git names them.")
]
_Match = Annotated[
    str, typer.Option("--match", metavar="REGEX", help="What the message of a commit has that is a fix.")
]
_To = Annotated[str, typer.Option("--to", metavar="FOLDER", help="Where patches are written.")]


def patches(
    context: CommandContext,
    paths: _PatchPaths = None,
    *,
    from_git: _FromGit,
    match: _Match = FIXES,
    to: _To = "patches",
    json: bool = False,
) -> None:
    """Write patches that take back fixes of the repository's history.

    Each undoes what one commit changed in the program, if it still applies. `mutabot run --family patch` runs
    them.
    """
    root = context.journal.parent.parent
    found = list(reverted(root, from_git, match, paths or []))
    states = {reversal.commit: _write(root, to, reversal) for reversal in found}
    if json:
        data = [
            {"commit": reversal.commit, "subject": reversal.subject, **states[reversal.commit]}
            for reversal in found
        ]
        context.print_json({"commits": data})
        return
    for commit in found:
        file, why = states[commit.commit]["file"], states[commit.commit]["why_not"]
        context.print(
            f"{file or 'no patch'}  {commit.commit[:10]} {commit.subject}{f': {why}' if why else ''}"
        )
    written = sum(bool(state["file"]) for state in states.values())
    context.notify([f"{written} of {len(found)} fixes can be taken back: mutabot run --family {FAMILY}"])


def _write(root: Path, to: str, commit: Reverted) -> dict[str, str | None]:
    """Write a patch; return its file in the project, or why there is none. Raises UsageError."""
    if commit.why_not:
        return {"file": None, "why_not": commit.why_not}
    path = root / to / commit.name
    if not path.resolve().is_relative_to(root.resolve()):
        raise UsageError(f"--to {to} lies outside the project: name a folder in it")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(commit.content)
    except OSError as error:
        raise UsageError(f"--to {to}: {error.strerror or error}") from None
    return {"file": path.relative_to(root).as_posix(), "why_not": None}
