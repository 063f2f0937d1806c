"""What an outcome depends on, by content: what is as it was need not be run again.

An outcome has a *key* of three digests: of what all outcomes share (files, settings, versions), of what
those at its place share (test files that judge it, entries of the vocabulary), and of the mutant's own. The
first two stand for *parts*, names with a digest or a plain value each, which tell what has changed.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import stat
import sys
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Set
from dataclasses import dataclass
from importlib.metadata import distributions
from itertools import islice
from pathlib import Path, PurePosixPath
from typing import Any

import mutabot
from mutabot.model import Mutant, Vocabulary, to_data
from mutabot.model.idle import Idle

from .baseline import Baseline
from .counted import WRITTEN, counted
from .request import Request

#: what something is made of: names, and a digest or a plain value for each
Parts = Mapping[str, str]

#: folders without anything that a test imports or reads; hidden ones are left out as well
_FOLDERS = {"__pycache__", "node_modules", "site-packages"}
_SUFFIXES = (".pyc", ".pyo", ".swp", "~", ".egg-info", ".dist-info")
#: files for people and for other tools
_FOR_PEOPLE = re.compile(
    r"(README|CHANGELOG|CHANGES|CONTRIBUTING|LICEN[SC]E|AUTHORS)(\.(md|rst|txt|adoc))?", re.IGNORECASE
)
_FOR_TOOLS = {".gitignore", ".gitattributes", ".editorconfig", ".coverage", ".DS_Store"}
#: installed packages that have no say in how a test ends
_TOOLS = {"black", "hatchling", "isort", "mypy", "pip", "pre-commit", "ruff", "setuptools", "uv", "wheel"}
_CONFIGURATIONS = ("pyproject.toml", "pytest.ini", ".pytest.ini", "tox.ini", "setup.cfg", "conftest.py")
_REACHING = "which tests reach it"
_HASH = "#"


@dataclass(frozen=True, slots=True)
class _File:
    """One file: what the system says about it, and the digest of its content."""

    status: tuple[int, ...]
    digest: str


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The files of a project at one moment, by their path relative to its root."""

    files: Mapping[str, _File]

    @classmethod
    def take(cls, root: Path, before: Snapshot | None = None) -> Snapshot:
        """Read all files; those that the system says are untouched since ``before`` need not be read."""
        known = before.files if before is not None else {}
        found = {}
        for name, path, status in _walk(root):
            same = known.get(name)
            if same is not None and same.status == status:
                found[name] = same
                continue
            digest = _digest_of(path)
            if digest is not None:
                found[name] = _File(status, digest)
        return cls(found)

    @property
    def folders(self) -> set[str]:
        """The folders with files in them, relative to the root."""
        return {PurePosixPath(name).parent.as_posix() for name in self.files} | {"."}

    def edited_since(self, before: Mapping[str, str]) -> list[str]:
        """Files that had another digest, or are gone."""
        return [name for name, was in before.items() if was not in (WRITTEN, self._digest(name))]

    def edited_programs(self, before: Snapshot) -> list[str]:
        """Python files of ``before`` that have another content now, or are gone."""
        programs = {name: file.digest for name, file in before.files.items() if name.endswith(".py")}
        return self.edited_since(programs)

    def touched_since(self, before: Snapshot) -> set[str]:
        """Files that were written since ``before``, be it with the same content."""
        known = before.files
        return {
            name
            for name, file in self.files.items()
            if name not in known or known[name].status != file.status
        }

    def _digest(self, name: str) -> str | None:
        file = self.files.get(name)
        return file.digest if file is not None else None


def _walk(root: Path) -> Iterator[tuple[str, Path, tuple[int, ...]]]:
    """The regular files that could matter, with what tells whether they were touched."""
    for folder, folders, names in os.walk(root):
        here = Path(folder)
        folders[:] = sorted(name for name in folders if _is_folder_of_project(here / name))
        for name in sorted(names):
            if name.endswith(_SUFFIXES) or name in _FOR_TOOLS or _FOR_PEOPLE.fullmatch(name):
                continue
            path = here / name
            try:
                status = path.stat()
            except OSError:
                continue  # it is gone, or a link to nowhere
            if stat.S_ISREG(status.st_mode):
                times = (status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns)
                yield path.relative_to(root).as_posix(), path, times


def _is_folder_of_project(folder: Path) -> bool:
    name = folder.name
    if name.startswith(".") or name in _FOLDERS or name.endswith(_SUFFIXES):
        return False
    return not (folder / "pyvenv.cfg").exists()


def _digest_of(path: Path) -> str | None:
    try:
        with path.open("rb") as file:
            return _HASH + hashlib.file_digest(file, _new_hash).hexdigest()
    except FileNotFoundError:
        return None
    except OSError as error:
        return f"cannot be read: {error.strerror}"


def _new_hash() -> Any:
    return hashlib.blake2b(digest_size=12)


def _digest(data: Any) -> str:
    text = json.dumps(data, sort_keys=True, default=str)
    return hashlib.blake2b(text.encode(), digest_size=12).hexdigest()


class Dependencies:
    """What the outcomes of a campaign depend on.

    Args:
        request, baseline: the campaign.
        tests: all tests that the baseline collected.
        before, after: the project's files before and after the baseline.
        opened: the files that were opened meanwhile; None if that is not known.

    Attributes:
        files: the files that count, with their digests.
        parts: what the digests in keys stand for; grows as keys are made.
    """

    def __init__(
        self,
        request: Request,
        baseline: Baseline,
        tests: Iterable[str],
        before: Snapshot,
        after: Snapshot,
        opened: Set[str] | None = None,
    ) -> None:
        self.files = counted(
            request,
            {name: file.digest for name, file in after.files.items()},
            after.touched_since(before),
            opened,
        )
        self.parts: dict[str, Parts] = {}
        self._told = 0
        self._baseline = baseline
        self._test_files = _TestFiles.of(request, self.files, tests)
        self._places: dict[tuple[int, tuple[str, ...], tuple[str, ...]], str] = {}
        common = {
            **{name: digest for name, digest in self.files.items() if name not in self._test_files.closures},
            **_pytest_parts(request),
            **_settings(request),
            **_vocabulary_parts(request.vocabulary),
            **_versions(),
        }
        self._common = self._stored(common)
        self._operations = {
            operation.target: _operation_parts(request.vocabulary, operation.target)
            for operation in request.vocabulary.operations
        }

    def keys(self, mutant: Mutant, round: int) -> tuple[str, ...]:
        """Keys of outcomes that are still valid, the first being that of an outcome found now.

        The second is that of tests that had turned out to pass only together with all others.
        """
        selections = (self._baseline.judges(round, mutant), tuple(self._baseline.tests[round]))
        own = _digest([self._own(single, round) for single in mutant.singles])
        return tuple(
            f"{self._common} {self._of_place(round, tests, self._operations_of(mutant))} {own}"
            for tests in dict.fromkeys(selections)
        )

    def still_hold(self, key: str, of_place: Parts) -> bool:
        """Whether all that is known now of what a key stands for is as it was; the rest is taken for granted.

        For mutants of which nothing is known now, because their families are not asked for.
        """
        if key.split(maxsplit=1)[0] != self._common:
            return False
        now: dict[str, str] = dict(self.files)
        for parts in self._operations.values():
            now.update(parts)
        return bool(of_place) and all(
            now.get(name) == value for name, value in of_place.items() if name != _REACHING
        )

    def _own(self, mutant: Mutant, round: int) -> list[Any]:
        """What a mutant does, beyond what its id says; of one in the program text, what it reads there."""
        planted = self._baseline.program.planted.get(mutant.id)
        if planted is None:
            return [Idle.of(mutant.idle).in_round(round), mutant.pattern]
        return [to_data(planted.place.alternatives[planted.choice.index])]

    def new_parts(self) -> Mapping[str, Parts]:
        """The parts that have come since this was last asked."""
        new = dict(islice(self.parts.items(), self._told, None))
        self._told = len(self.parts)
        return new

    def _operations_of(self, mutant: Mutant) -> tuple[str, ...]:
        """The operations whose meaning counts: to a mutant of the program text, any might refuse."""
        named = tuple(single.operation for single in mutant.singles)
        return named if all(named) else tuple(self._operations)

    def _of_place(self, round: int, tests: tuple[str, ...], operations: tuple[str, ...]) -> str:
        found = self._places.get((round, tests, operations))
        if found is None:
            parts = {
                **self._test_files.parts(tests),
                **{
                    name: digest
                    for operation in operations
                    for name, digest in self._operations.get(operation, {}).items()
                },
                _REACHING: _HASH + _digest(sorted(tests)),
            }
            found = self._places[round, tests, operations] = self._stored(parts)
        return found

    def _stored(self, parts: Parts) -> str:
        digest = _digest(parts)
        self.parts[digest] = parts
        return digest


def changes(old: Parts, new: Parts) -> list[str]:
    """What differs, in words, files of the project first."""
    found = []
    for name in sorted({*old, *new}, key=lambda name: (_is_setting(old, new, name), name)):
        before, now = old.get(name), new.get(name)
        if before == now:
            continue
        if before is None:
            found.append(f"{name} is new")
        elif now is None:
            found.append(f"{name} is gone")
        elif _is_setting(old, new, name):
            found.append(f"{name} is {now}, was {before}")
        else:
            found.append(f"{name} changed")
    return found


def _is_setting(old: Parts, new: Parts, name: str) -> bool:
    return not any(parts.get(name, "").startswith(_HASH) for parts in (old, new))


@dataclass(frozen=True, slots=True)
class _TestFiles:
    """The test files: each counts for the mutants that its tests judge.

    Attributes:
        digests: all files that count.
        closures: test file to all test files whose names it mentions, itself included.
    """

    digests: Mapping[str, str]
    closures: Mapping[str, frozenset[str]]

    @classmethod
    def of(cls, request: Request, files: Mapping[str, str], tests: Iterable[str]) -> _TestFiles:
        """Those that hold these tests, bar what other files of the project mention."""
        configuration = request.configuration
        sources = (*configuration.program, *configuration.oracle)
        found = {_file_of(test, files) for test in tests} & set(files)
        found = {name for name in found if not any(_is_in(name, source) for source in sources)}
        by_stem: dict[bytes, set[str]] = {}
        for name in found:
            by_stem.setdefault(PurePosixPath(name).stem.encode(), set()).add(name)
        mentions = {name: _mentioned(request.root / name, by_stem) for name in files if name.endswith(".py")}
        closures = {name: frozenset(_closure(name, mentions)) for name in found}
        shared = {name for other in set(mentions) - found for name in mentions[other]}
        shared = {name for other in shared for name in closures[other]}
        return cls(files, {name: closures[name] for name in found - shared})

    def parts(self, tests: Iterable[str]) -> dict[str, str]:
        """The files of these tests with their digests."""
        files = {_file_of(test, self.digests) for test in tests}
        needed = {name for file in files for name in self.closures.get(file, ())}
        return {name: self.digests[name] for name in needed if name in self.closures}


def _file_of(test: str, files: Mapping[str, str]) -> str:
    """The test's file relative to the project's root; pytest's root may be a folder above."""
    name = test.partition("::")[0]
    while name not in files and "/" in name:
        name = name.partition("/")[2]
    return name


def _is_in(name: str, source: str) -> bool:
    return source in (".", name) or name.startswith(source + "/")


def _mentioned(path: Path, by_stem: Mapping[bytes, set[str]]) -> set[str]:
    """The test files whose names stand in a file: it may import them."""
    try:
        content = path.read_bytes()
    except OSError:
        return set()
    if b"test" not in content and all(b"test" in stem for stem in by_stem):
        return set()
    words = by_stem.keys() & set(re.findall(rb"\w+", content))
    return {name for word in words for name in by_stem[word]}


def _closure(name: str, mentions: Mapping[str, set[str]]) -> set[str]:
    found, waiting = {name}, [name]
    while waiting:
        new = mentions.get(waiting.pop(), set()) - found
        found |= new
        waiting.extend(new)
    return found


def _settings(request: Request) -> dict[str, str]:
    configuration = request.configuration
    return {
        "seed": str(request.seed),
        "program": ", ".join(configuration.program),
        "oracle": ", ".join(configuration.oracle) or "none",
        "timeout_factor": str(configuration.timeout_factor),
        "timeout_seconds": str(configuration.timeout_seconds),
        "memory": str(configuration.memory),
        **({"every test": "run"} if request.every_test else {}),
        **({"the checks": "switched off"} if request.no_oracle else {}),
    }


def _pytest_parts(request: Request) -> dict[str, str]:
    """Pytest's arguments, and configuration that it finds in folders above the project."""
    parts = {"pytest's arguments": " ".join(request.arguments)}
    for depth, folder in enumerate((request.root, *request.root.parents)):
        for name in _CONFIGURATIONS:
            path = folder / name
            if not path.is_file():
                continue
            shown = "../" * depth + name
            if name == "pyproject.toml":
                parts[f"tool.pytest in {shown}"] = _HASH + _digest(_pytest_table(path))
            elif depth:
                parts[shown] = _digest_of(path) or _HASH
    return parts


def _pytest_table(path: Path) -> Any:
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    tool = data.get("tool")
    return tool.get("pytest") if isinstance(tool, dict) else None


def _vocabulary_parts(vocabulary: Vocabulary) -> dict[str, str]:
    names = ("refusals", "checks", "failures", "clock", "probes")
    return {
        f"{name} of the vocabulary": _HASH + _digest(_meaning(getattr(vocabulary, name))) for name in names
    }


def _operation_parts(vocabulary: Vocabulary, target: str) -> dict[str, str]:
    """The entry of an operation, and those of the operations that its mutants need."""
    parts: dict[str, str] = {}
    waiting: list[str | None] = [target]
    while waiting:
        operation = vocabulary.operation(waiting.pop() or "")
        name = f"{operation.target} in the vocabulary" if operation is not None else ""
        if operation is not None and name not in parts:
            parts[name] = _HASH + _digest(_meaning(operation))
            waiting += [operation.current, operation.opposite]
    return parts


def _meaning(value: Any) -> Any:
    """What an entry says, without the line it stands in."""
    return _without_source(to_data(value))


def _without_source(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _without_source(item) for key, item in data.items() if key != "source"}
    return [_without_source(item) for item in data] if isinstance(data, list) else data


def _versions() -> dict[str, str]:
    """Python, and all that is installed beside it, for any of it may take part in a simulation."""
    found = {
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "machine": f"{sys.platform} {platform.machine()}",
    }
    for distribution in distributions():
        name = (distribution.metadata["Name"] or "").lower()
        if name and name not in _TOOLS and name != "mutabot":
            found.setdefault(name, distribution.version)
    return {**found, "mutabot": mutabot.__version__, "mutabot's own code": _HASH + _own_code()}


def _own_code() -> str:
    """Of a mutabot that is being worked on, the version alone does not tell what it does."""
    home = Path(mutabot.__file__).parent
    parts = ("model", "operators", "inside", "classical", "campaign")
    files = sorted(file for part in parts for file in (home / part).rglob("*.py"))
    return _digest([(file.relative_to(home).as_posix(), _digest_of(file)) for file in files])
