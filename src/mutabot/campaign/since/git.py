"""Git, asked by its own program: it is where there are revisions, and nothing else reads all repositories.

Nothing is ever written, not even the index.
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from mutabot.errors import UsageError
from mutabot.frozen import frozen

_OPTION = "--since"


@frozen
class Revision:
    """A revision of the repository that a project lies in.

    Attributes:
        project: the project's folder.
        top: the repository's folder.
        ref: the revision as the user named it.
        commit: its commit.
        changed: files of the repository, relative to it, that are not now as they were then, also untracked
            ones; and whether they were there.
    """

    project: Path
    top: Path
    ref: str
    commit: str
    changed: dict[str, bool]

    @classmethod
    def find(cls, project: Path, ref: str) -> Revision:
        """Look it up. Raises UsageError, saying what to do."""
        project = project.resolve()
        top = Path(
            _asked(project, "rev-parse", "--show-toplevel", why=f"{project} is in no repository of git")
        )
        commit = _commit(project, ref)
        told = _git(top, "diff", "--name-status", "--no-renames", "-z", commit, "--").decode(
            "utf-8", "replace"
        )
        words = told.split("\0")[:-1]
        changed = {name: status != "A" for status, name in zip(words[::2], words[1::2], strict=True)}
        for name in _words(top, "ls-files", "--others", "--exclude-standard", "-z"):
            changed.setdefault(name, False)
        return cls(project, top.resolve(), ref, commit, changed)

    @property
    def short(self) -> str:
        """``main (1a2b3c4)``."""
        abbreviated = self.commit[:7]
        return self.ref if self.ref.startswith(abbreviated) else f"{self.ref} ({abbreviated})"

    @property
    def prefix(self) -> str:
        """Where the project lies in the repository: empty, or a folder with a slash."""
        folder = self.project.relative_to(self.top).as_posix()
        return "" if folder == "." else f"{folder}/"

    def is_changed(self, path: Path) -> bool:
        """Whether a file is not as it was; one outside of the repository is taken for unchanged."""
        return self._name(path) in self.changed

    def read(self, path: Path) -> bytes | None:
        """What a file held then; None if it was not there. What lies outside of the repository is as now."""
        name = self._name(path)
        if name not in self.changed:
            try:
                return path.read_bytes()
            except OSError:
                return None
        if not self.changed[name]:
            return None
        return _git(self.top, "cat-file", "blob", f"{self.commit}:{name}")

    def gone(self) -> list[str]:
        """Files of the project, relative to it, that were there and are not any more."""
        here = [
            name for name, was_there in self.changed.items() if was_there and name.startswith(self.prefix)
        ]
        names = (name.removeprefix(self.prefix) for name in here)
        return [name for name in names if not (self.project / name).is_file()]

    def _name(self, path: Path) -> str:
        folder = path.parent.resolve()  # a link in the project is a file of its own
        try:
            return (folder / path.name).relative_to(self.top).as_posix()
        except ValueError:
            return ""


def _commit(project: Path, ref: str) -> str:
    if ref.startswith("-"):
        raise UsageError(f"{_OPTION} {ref}: that is no name of a revision")
    done = _run(project, "rev-parse", "--verify", "--quiet", f"{ref}^{{commit}}")
    if done.returncode == 0:
        return done.stdout.decode().strip()
    if _git(project, "rev-parse", "--is-shallow-repository").strip() == b"true":
        raise UsageError(
            f"{_OPTION} {ref}: this clone is shallow and does not hold that revision; fetch it: `git fetch "
            f"--unshallow`, in GitHub Actions `fetch-depth: 0` of actions/checkout, in GitLab `GIT_DEPTH: 0`"
        )
    hint = f"; `git fetch origin {ref}` and origin/{ref}?" if "/" not in ref else ""
    raise UsageError(f"{_OPTION} {ref}: git knows no such revision{hint}")


def _asked(folder: Path, *question: str, why: str) -> str:
    done = _run(folder, *question)
    if done.returncode:
        said = done.stderr.decode("utf-8", "replace").strip()
        if "dubious ownership" in said:
            raise UsageError(f"{_OPTION}: git refuses {folder}: {said.splitlines()[0]}")
        raise UsageError(f"{_OPTION}: {why}; without one, `mutabot run` itself runs what has changed")
    return done.stdout.decode("utf-8", "surrogateescape").removesuffix("\n")


def _words(folder: Path, *command: str) -> list[str]:
    """What git says, ended by zeros."""
    return _git(folder, *command).decode("utf-8", "surrogateescape").split("\0")[:-1]


def _git(folder: Path, *command: str) -> bytes:
    done = _run(folder, *command)
    if done.returncode:
        said = done.stderr.decode("utf-8", "replace").strip()
        raise UsageError(f"{_OPTION}: git {command[0]} failed: {said or f'exit code {done.returncode}'}")
    return done.stdout


def _run(folder: Path, *command: str) -> subprocess.CompletedProcess[bytes]:
    environment = {**os.environ, "GIT_OPTIONAL_LOCKS": "0", "LC_ALL": "C"}
    try:
        return subprocess.run(
            ["git", "-C", str(folder), *command], capture_output=True, check=False, env=environment
        )
    except OSError as error:
        raise UsageError(f"{_OPTION} needs git, which cannot be started: {error.strerror}") from error
