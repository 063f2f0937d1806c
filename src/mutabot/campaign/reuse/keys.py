"""What an outcome depends on, by content: what is as it was need not be run again.

An outcome has a *key* of three digests: of what all outcomes share (files, settings, versions), of what
those at its place share (test files that judge it, entries of the vocabulary), and of the mutant's own. The
first two stand for *parts*, names with a digest or a plain value each, which tell what has changed.
"""

from __future__ import annotations

import hashlib
import json
import platform
import sys
import tomllib
from collections.abc import Iterable, Mapping, Set
from importlib.metadata import distributions
from itertools import islice
from pathlib import Path
from typing import Any

import mutabot
from mutabot.border.codec import to_data
from mutabot.border.idle import Idle
from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.request import Request
from mutabot.model import Mutant, Vocabulary

from .counted import counted
from .snapshot import _HASH, Snapshot, _digest_of
from .suite_files import _TestFiles

#: what something is made of: names, and a digest or a plain value for each
Parts = Mapping[str, str]

#: installed packages that have no say in how a test ends
_TOOLS = {"black", "hatchling", "isort", "mypy", "pip", "pre-commit", "ruff", "setuptools", "uv", "wheel"}
_CONFIGURATIONS = ("pyproject.toml", "pytest.ini", ".pytest.ini", "tox.ini", "setup.cfg", "conftest.py")
_REACHING = "which tests reach it"


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
            **versions(),
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


def _settings(request: Request) -> dict[str, str]:
    configuration = request.configuration
    return {
        "seed": str(request.seed),
        "program": ", ".join(configuration.program),
        "oracle": ", ".join(configuration.oracle) or "none",
        "oracle_nodes": ", ".join(configuration.oracle_nodes) or "none",
        "timeout_factor": str(configuration.timeout_factor),
        "timeout_seconds": str(configuration.timeout_seconds),
        "memory": str(configuration.memory),
        **({"every test": "run"} if request.every_test else {}),
        **({"the checks": "switched off"} if request.no_oracle else {}),
        **({"workers": "may run with other versions"} if request.is_mixed else {}),
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
    waiting = [target]
    while waiting:
        operation = vocabulary.operation(waiting.pop())
        name = f"{operation.target} in the vocabulary" if operation is not None else ""
        if operation is not None and name not in parts:
            parts[name] = _HASH + _digest(_meaning(operation))
            waiting += [*operation.currents, *operation.opposites]
    return parts


def _meaning(value: Any) -> Any:
    """What an entry says, without the line it stands in."""
    return _without_source(to_data(value))


def _without_source(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _without_source(item) for key, item in data.items() if key != "source"}
    return [_without_source(item) for item in data] if isinstance(data, list) else data


def versions() -> dict[str, str]:
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
