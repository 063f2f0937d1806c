"""``mutabot init --TEMPLATE VALUE``: starts a project from another package's template."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath

from mutabot.api.reports import UsageError


def start(root: Path, program: Sequence[Path], name: str, files: Mapping[str, str]) -> list[str]:
    """Write the project of a template; return lines on what was written and what comes next.

    Args:
        root: the project's folder; made if it is not there.
        program: as given to ``mutabot init``; a template brings its own.
        name: the option's.
        files: the texts of the project's files, by their paths relative to ``root``, with ``/``.

    Raises UsageError if a file is there already or cannot be written.
    """
    if program:
        given = ", ".join(map(str, program))
        raise UsageError(
            f"--{name} writes a project into {root}, with a program of its own: leave {given} out, "
            "and make a folder first for a project elsewhere"
        )
    paths = {root.joinpath(*PurePosixPath(file).parts): text for file, text in files.items()}
    for path in paths:
        if path.exists():
            raise UsageError(f"{path} exists already; init never overwrites a file")
    for path, text in paths.items():
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        except OSError as error:
            raise UsageError(f"cannot write {path}: {error.strerror or error}") from error
    return [
        *(f"wrote {file}" for file in files),
        "next: `python -m pytest`, then `mutabot check`, `mutabot list`, `mutabot run`",
    ]
