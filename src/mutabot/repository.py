"""Read-only queries to git, by running its program, since only that reads every kind of repository."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

#: variables by which git would look at another repository than the one that a folder lies in
_OF_A_REPOSITORY = {
    "GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE", "GIT_PREFIX", "GIT_COMMON_DIR", "GIT_NAMESPACE",
    "GIT_OBJECT_DIRECTORY", "GIT_ALTERNATE_OBJECT_DIRECTORIES", "GIT_INTERNAL_SUPER_PREFIX",
    "GIT_CEILING_DIRECTORIES", "GIT_LITERAL_PATHSPECS", "GIT_GLOB_PATHSPECS", "GIT_NOGLOB_PATHSPECS",
    "GIT_ICASE_PATHSPECS",
}  # fmt: skip


class GitError(Exception):
    """Git cannot answer; the text says why."""


def repository_of(folder: Path) -> Path | None:
    """Return the top of the repository that a folder lies in; None if it lies in none."""
    return next((path for path in (folder, *folder.parents) if (path / ".git").exists()), None)


def tracked(folder: Path, *names: str) -> list[str]:
    """Return the files below a folder that git tracks, relative to it, those of submodules included.

    ``names``: only these files, and what is below them if they are folders. Raises GitError.
    """
    if not names:
        return _listed(folder, "--cached", "--recurse-submodules")
    return _listed(folder, "--cached", "--", *(f":(literal){name}" for name in names))


def unignored(folder: Path) -> list[str]:
    """List the files below a folder that git neither tracks nor ignores.

    Raises GitError.
    """
    return _listed(folder, "--others", "--exclude-standard")


def _listed(folder: Path, *options: str) -> list[str]:
    done = git(folder, "ls-files", "-z", *options)
    if done.returncode:
        messages = os.fsdecode(done.stderr).strip().splitlines()
        raise GitError(f"git says: {messages[0] if messages else f'exit code {done.returncode}'}")
    return list(dict.fromkeys(os.fsdecode(name) for name in done.stdout.split(b"\0") if name))


def git(folder: Path, *command: str) -> subprocess.CompletedProcess[bytes]:
    """Run git in a folder without letting it write. Raises GitError if it cannot be started."""
    environment = {name: value for name, value in os.environ.items() if name not in _OF_A_REPOSITORY}
    environment |= {"GIT_OPTIONAL_LOCKS": "0", "LC_ALL": "C"}
    command_line = ["git", "-C", os.fspath(folder), *command]
    try:
        return subprocess.run(command_line, capture_output=True, check=False, env=environment)
    except OSError as error:
        raise GitError(f"git cannot be started: {error.strerror}") from error
