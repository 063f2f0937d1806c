"""Makes patches from a repository's history: each reverts a commit in the present program.

Only a commit's files of the program and its data are taken back; tests, documentation and what builds the
project stay as they are. Git is asked by its own program, and nothing is written in the repository.
"""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from mutabot.api.reports import UsageError

from .changes import read_patch
from .diffs import PatchError
from .suite import looks_like_tests

#: messages of commits that mend something
FIXES = r"\b(fix(es|ed|ing)?|bugs?|wrong(ly)?|correct(s|ed)?|repair(s|ed)?|broken|regression)\b"
#: ends of the names of files that a robot program consists of
_OF_PROGRAM = {
    ".py", ".json", ".yaml", ".yml", ".toml", ".xml", ".urdf", ".srdf", ".xacro", ".launch", ".ini", ".cfg",
    ".csv", ".script", ".rviz", ".msg", ".srv", ".action",
}  # fmt: skip
_DIFF = (
    "diff", "--no-color", "--no-ext-diff", "--no-textconv", "--no-renames", "--relative", "--src-prefix=a/",
    "--dst-prefix=b/",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Reverted:
    """A reverted commit.

    Attributes:
        commit: its hash.
        subject: the first line of its message.
        content: the patch; empty if there is none.
        why_not: why there is none; empty if there is one.
    """

    commit: str
    subject: str
    content: bytes = b""
    why_not: str = ""

    @property
    def name(self) -> str:
        """The name of its file."""
        return f"{self.commit[:10]}.patch"


def reverted(root: Path, commits: str, match: str, paths: Sequence[str]) -> Iterator[Reverted]:
    """Yield the commits that fix something, oldest first, each reverted in the present program.

    Args:
        root: the project's folder.
        commits: a range as git writes it: ``v1.0..HEAD``.
        match: a regular expression to search for in messages, ignoring case.
        paths: files and folders of the program, relative to ``root``; all if empty.

    Raises UsageError.
    """
    try:
        wanted = re.compile(match, re.IGNORECASE)
    except re.error as error:
        raise UsageError(f"--match {match!r} is no regular expression: {error}") from None
    if commits.startswith("-"):
        raise UsageError(f"--from-git {commits!r} is no range of commits, such as v1.0..HEAD")
    log = git(root, "log", "--no-merges", "--reverse", "--format=%H%x00%B%x01", commits, "--")
    for entry in log.decode("utf-8", errors="replace").split("\x01"):
        commit, _, message = entry.strip().partition("\0")
        if commit and wanted.search(message):
            yield _reverted(root, commit, (message.splitlines() or [""])[0], paths or ["."])


def _reverted(root: Path, commit: str, subject: str, paths: Sequence[str]) -> Reverted:
    parents = git(root, "log", "-1", "--format=%P", commit, "--").split()
    if not parents:
        return Reverted(commit, subject, why_not="it is the first commit: there is nothing to go back to")
    sides = commit, parents[0].decode()
    named = git(root, *_DIFF, "--name-only", "-z", *sides, "--", *paths)
    names = [os.fsdecode(name) for name in named.split(b"\0") if name]
    files = [
        name for name in names if PurePosixPath(name).suffix in _OF_PROGRAM and not looks_like_tests(name)
    ]
    if not files:
        return Reverted(commit, subject, why_not="it changes no file of the program")
    diff = git(root, *_DIFF, *sides, "--", *(f":(literal){file}" for file in files))
    try:
        read_patch(diff, root, looks_like_tests)
    except PatchError as error:
        return Reverted(commit, subject, why_not=str(error))
    return Reverted(commit, subject, f"Reverted: {subject}\nCommit: {commit}\n\n".encode() + diff)


def git(folder: Path, *command: str) -> bytes:
    """Return git's output for the repository of a folder. Raises UsageError if it fails."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    environment |= {"GIT_OPTIONAL_LOCKS": "0", "LC_ALL": "C"}
    command_line = ["git", "-C", os.fspath(folder), "-c", "core.quotePath=true", *command]
    try:
        done = subprocess.run(command_line, capture_output=True, check=False, env=environment)
    except OSError as error:
        raise UsageError(f"git cannot be started: {error.strerror}") from None
    if done.returncode:
        errors = os.fsdecode(done.stderr).strip().splitlines()
        raise UsageError(f"git says: {errors[0] if errors else f'exit code {done.returncode}'}")
    return done.stdout
