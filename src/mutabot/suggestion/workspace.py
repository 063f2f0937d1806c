"""Private copies of a project, in which tests are changed: nothing is ever written to the user's own."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from mutabot.campaign.request import Request
from mutabot.errors import ConfigurationError
from mutabot.journal.files import HOME

#: folders that no test needs and that may be large
_LEFT = {HOME, ".git", ".hg", "__pycache__", ".pytest_cache", ".mypy_cache", ".ruff_cache", ".tox", ".nox"}
_LEFT |= {"node_modules"}
_PATH = "PYTHONPATH"


@contextmanager
def copy_of(request: Request, texts: Mapping[str, str]) -> Iterator[Request]:
    """The request for a private copy of the project in which files have these texts.

    Raises ConfigurationError if there is no place for it.
    """
    home = Path(tempfile.mkdtemp(prefix="mutabot-suggest-"))
    root = home / request.root.name
    before = os.environ.get(_PATH)
    try:
        try:
            shutil.copytree(request.root, root, symlinks=True, ignore=_ignored)
            for file, text in texts.items():
                (root / file).parent.mkdir(parents=True, exist_ok=True)
                (root / file).write_bytes(text.encode("utf-8"))
        except (OSError, shutil.Error) as error:
            problem = f"the project cannot be copied to {home} (set TMPDIR to another place): {error}"
            raise ConfigurationError(problem) from error
        os.environ[_PATH] = os.pathsep.join(_paths(request.root, root, before))
        yield replace(request, configuration=request.configuration.model_copy(update={"root": root}))
    finally:
        if before is None:
            os.environ.pop(_PATH, None)
        else:
            os.environ[_PATH] = before
        shutil.rmtree(home, ignore_errors=True)


def _ignored(folder: str, names: Sequence[str]) -> set[str]:
    return {name for name in names if name in _LEFT or Path(folder, name, "pyvenv.cfg").exists()}


def _paths(own: Path, copy: Path, before: str | None) -> list[str]:
    """Where the copy's modules are found, before those of an installation that points to the project."""
    found = [str(copy / "src")] if (copy / "src").is_dir() else []
    given = [entry for entry in (before or "").split(os.pathsep) if entry]
    for entry in [*given, *sys.path[1:]]:  # the first is where this process was started
        path = Path(entry).resolve()
        copied = copy / path.relative_to(own) if path.is_relative_to(own) else None
        if copied is not None and copied.is_dir():
            found.append(str(copied))
        elif copied is None and entry in given:
            found.append(entry)
    return list(dict.fromkeys(found))
