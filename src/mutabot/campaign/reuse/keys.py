"""What an outcome depends on, by content: what is as it was need not be run again.

An outcome has a *key* of four digests: of what all outcomes share (settings, versions, files that are no
program text), of what those at its place share (tests, all that these can reach, entries of the vocabulary),
of the mutant's own, and of the Python files when it was found. The last one does not count: it tells where
lines have gone since, and what has changed. All but the third stand for *parts*, names with a digest or a
plain value each.

The tests are those that reach the mutant. The others count only where one of them has noticed it: then all
tests do.
"""

from __future__ import annotations

import hashlib
import json
import platform
import sys
import tomllib
from collections.abc import Callable, Iterable, Mapping
from importlib.metadata import distributions
from itertools import islice
from pathlib import Path
from typing import Any

import mutabot
from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.pieces.mentions import names_in
from mutabot.campaign.pieces.project import Project
from mutabot.campaign.pieces.reach import Reach, Reached
from mutabot.campaign.request import Request
from mutabot.model import Mutant, Outcome, Vocabulary
from mutabot.model.codec import to_data
from mutabot.model.job import Idle

from .snapshot import _HASH, State, _digest_of, read

#: what something is made of: names, and a digest or a plain value for each
Parts = Mapping[str, str]

#: installed packages that have no say in how a test ends
_TOOLS = {"black", "hatchling", "isort", "mypy", "pip", "pre-commit", "ruff", "setuptools", "uv", "wheel"}
_CONFIGURATIONS = ("pyproject.toml", "pytest.ini", ".pytest.ini", "tox.ini", "setup.cfg", "conftest.py")
#: parts of a place that are not looked at by name
REACHING, REACHED, ASIDE = "which tests reach it", "what its tests can reach", "which tests are set aside"
#: in the place of the first, if a test that does not reach it has noticed it: all tests count
SUITE = "which tests there are"


def _digest(data: Any) -> str:
    text = json.dumps(data, sort_keys=True, default=str)
    return hashlib.blake2b(text.encode(), digest_size=12).hexdigest()


def says_same(key: str, other: str) -> bool:
    """Whether two keys stand for the same, whatever the files are in which that stands."""
    return key.split()[:3] == other.split()[:3]


class Dependencies:
    """What the outcomes of a campaign depend on.

    Args:
        request, baseline: the campaign.
        tests: all tests that the baseline collected.
        state: the project's files.
        read: what a file of the configuration holds.

    Attributes:
        request: the campaign.
        files: the files that count, with their digests.
        parts: what the digests in keys stand for; grows as keys are made.
        texts: what stands in the Python files.
        tree: the digest of the Python files together.
        reach: what tests can run.
    """

    def __init__(
        self,
        request: Request,
        baseline: Baseline,
        tests: Iterable[str],
        state: State,
        read: Callable[[Path], bytes | None] = read,
    ) -> None:
        self.files, self.texts = state.files, state.texts
        self.parts: dict[str, Parts] = {}
        self._told = 0
        self.request, self._baseline, self.names = request, baseline, state.names
        self._test_files = {self.file_of(test) for test in tests}
        self._places: dict[Any, str] = {}
        self._targets: dict[str, set[str]] = {}
        self._reached: dict[Any, Reached] = {}
        code = {name: digest for name, digest in self.files.items() if name in self.texts}
        self.reach = self.reach_of(code, self.texts)
        self.tree = self._stored(code)
        self.common = {
            **{name: digest for name, digest in self.files.items() if name not in self.texts},
            **self.reach.project.around,
            **_pytest_parts(request, read),
            **_settings(request),
            **self._roles(name for name in self.files if name not in self.texts),
            **_vocabulary_parts(request.vocabulary),
            **versions(),
        }
        self._common = self._stored(self.common)
        self._operations = {
            operation.target: _operation_parts(request.vocabulary, operation.target)
            for operation in request.vocabulary.operations
        }

    def reach_of(self, digests: Mapping[str, str], texts: Mapping[str, bytes]) -> Reach:
        """What tests can run of these Python files, everything else being as it is now."""
        vocabulary = _without_source(to_data(self.request.vocabulary))
        everywhere = {*self.names, *_targets({**vocabulary, "operations": ()})}
        starts = any(end.processes for end in self._baseline.ends.values())
        return Reach(Project(digests, texts, self._test_files), everywhere, starts_processes=starts)

    def file_of(self, test: str) -> str:
        """The test's file relative to the project's root; pytest's root may be a folder above."""
        name = test.partition("::")[0]
        while name not in self.files and "/" in name:
            name = name.partition("/")[2]
        return name

    @property
    def everything(self) -> Parts:
        """All that any outcome depends on, but for what a mutant does."""
        return {
            **self.files,
            **self.common,
            **{k: v for one in self._operations.values() for k, v in one.items()},
        }

    def key(self, mutant: Mutant, round: int, *, whole: bool = False) -> str:
        """The key of an outcome that is found now; ``whole``: one that depends on all tests."""
        own = _digest([self._own(mutant, round)])
        return f"{self._common} {self._of_place(mutant, round, whole)} {own} {self.tree}"

    def key_of(self, outcome: Outcome, mutant: Mutant) -> str:
        """The key of this outcome."""
        noticed = {outcome.test, *(kill.test for kill in outcome.kills)}
        is_noticed = outcome.verdict.is_killed or outcome.test is not None
        whole = is_noticed and not noticed.issubset(self._baseline.tests_reaching(outcome.round, mutant))
        return self.key(mutant, outcome.round, whole=whole)

    def tests(self, mutant: Mutant, round: int, *, whole: bool) -> tuple[str, ...]:
        """The tests that an outcome depends on."""
        return self._baseline.suite(round) if whole else self._baseline.tests_reaching(round, mutant)

    def holding(self, key: str, mutant: Mutant, round: int) -> str | None:
        """The key of now for an outcome with this key, if it would come out the same; else None."""
        both = (self.key(mutant, round, whole=whole) for whole in (False, True))
        return next((now for now in both if says_same(key, now)), None)

    def still_hold(self, key: str, of_place: Parts) -> bool:
        """Whether all that is known now of what a key stands for is as it was; the rest is taken for granted.

        For mutants of which nothing is known now, because their families are not asked for.
        """
        words = key.split()
        if words[0] != self._common or words[3:] != [self.tree]:
            return False
        now = self._roles(self.files)
        for parts in self._operations.values():
            now.update(parts)
        unknown = {REACHING, SUITE, REACHED, ASIDE}
        return bool(of_place) and all(
            now.get(name) == value for name, value in of_place.items() if name not in unknown
        )

    def _own(self, mutant: Mutant, round: int) -> list[Any]:
        """What a mutant does, beyond what its id says."""
        planted = self._baseline.faults.by_id.get(mutant.id)
        does = planted.does if planted is not None else None
        return [mutant.provider, Idle.of(mutant.idle).in_round(round), mutant.pattern, does]

    def new_parts(self) -> Mapping[str, Parts]:
        """The parts that have come since this was last asked."""
        new = dict(islice(self.parts.items(), self._told, None))
        self._told = len(self.parts)
        return new

    def reached(self, mutant: Mutant, tests: tuple[str, ...], reach: Reach | None = None) -> Reached:
        """All that these tests can run as this mutant; ``reach``: in another state of the files."""
        reach = reach or self.reach
        place = mutant.site.span.file, mutant.site.span.function
        operations = self._operations_of(mutant)
        names = self._names_of(mutant)
        key = (id(reach), tests, place, operations, names)
        if key not in self._reached:
            found = {*reach.of_tests(tests, self.file_of), *reach.at(*place)}
            targets = {name for one in operations for name in self._operation_names(one)}
            found |= reach.closure((), {*names, *targets})
            self._reached[key] = frozenset(found)
        return self._reached[key]

    def _operation_names(self, target: str) -> set[str]:
        if target not in self._targets:
            vocabulary = self.request.vocabulary
            found = (vocabulary.operation(name) for name in _together(vocabulary, target))
            self._targets[target] = _targets([_meaning(one) for one in found if one is not None])
        return self._targets[target]

    def _names_of(self, mutant: Mutant) -> frozenset[str]:
        """Names that the text of a mutant mentions, beyond those of the original."""
        planted = self._baseline.faults.by_id.get(mutant.id)
        return frozenset(names_in(planted.mentions)) if planted is not None else frozenset()

    def _operations_of(self, mutant: Mutant) -> tuple[str, ...]:
        """The operations whose meaning counts: to a mutant that acts on none, any might refuse."""
        return (mutant.operation,) if mutant.operation else tuple(self._operations)

    def _of_place(self, mutant: Mutant, round: int, whole: bool) -> str:
        tests = self.tests(mutant, round, whole=whole)
        aside = tuple(self._baseline.missing_judges(round, mutant)) if self._baseline.unstable else ()
        key = (whole, tests, self.reached(mutant, tests), self._operations_of(mutant), aside)
        found = self._places.get(key)
        if found is None:
            found = self._places[key] = self._stored(self._place_parts(mutant, round, whole))
        return found

    def _place_parts(self, mutant: Mutant, round: int, whole: bool) -> dict[str, str]:
        tests = self.tests(mutant, round, whole=whole)
        reached = self.reached(mutant, tests)
        aside = self._baseline.missing_judges(round, mutant)
        return {
            **{
                name: digest
                for operation in self._operations_of(mutant)
                for name, digest in self._operations.get(operation, {}).items()
            },
            **self._roles(self.reach.files(reached)),
            (SUITE if whole else REACHING): _HASH + _digest(sorted(tests)),
            **({ASIDE: _HASH + _digest(sorted(aside))} if aside else {}),
            REACHED: _HASH + self.reach.digest(reached),
        }

    def _roles(self, files: Iterable[str]) -> dict[str, str]:
        """Which of these files are program and which are oracle."""
        roles = {f"role of {file}": role_of(file, self.request) for file in files}
        return {name: role for name, role in roles.items() if role}

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
        "oracle_nodes": ", ".join(configuration.oracle_nodes) or "none",
        "timeout_factor": str(configuration.timeout_factor),
        "timeout_seconds": str(configuration.timeout_seconds),
        "memory": str(configuration.memory),
        **({"every test": "run"} if request.every_test else {}),
    }


def role_of(file: str, request: Request) -> str:
    """Whose calls stand in a file: ``program``, ``oracle``, or empty."""
    configuration = request.configuration
    for role, sources in (("program", configuration.program), ("oracle", configuration.oracle)):
        if any(source in (".", file) or file.startswith(f"{source}/") for source in sources):
            return role
    return ""


def _pytest_parts(request: Request, read: Callable[[Path], bytes | None]) -> dict[str, str]:
    """Pytest's arguments, and configuration that it finds in folders above the project."""
    parts = {"pytest's arguments": " ".join(request.arguments)}
    for depth, folder in enumerate((request.root, *request.root.parents)):
        for name in _CONFIGURATIONS:
            text = read(folder / name)
            if text is None:
                continue
            shown = "../" * depth + name
            if name == "pyproject.toml":
                parts[f"tool.pytest in {shown}"] = _HASH + _digest(_pytest_table(text))
            elif depth:
                parts[shown] = _HASH + hashlib.blake2b(text, digest_size=12).hexdigest()
    return parts


def _pytest_table(text: bytes) -> Any:
    try:
        data = tomllib.loads(text.decode("utf-8"))
    except ValueError:
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
    return {
        f"{operation.target} in the vocabulary": _HASH + _digest(_meaning(operation))
        for name in _together(vocabulary, target)
        if (operation := vocabulary.operation(name)) is not None
    }


def _together(vocabulary: Vocabulary, target: str) -> list[str]:
    """An operation, and those that its mutants need."""
    found: dict[str, None] = {}
    waiting = [target]
    while waiting:
        operation = vocabulary.operation(waiting.pop())
        if operation is not None and operation.target not in found:
            found[operation.target] = None
            waiting += [*operation.currents, *operation.opposites]
    return list(found)


def _targets(data: Any) -> set[str]:
    """The names in what stands for something of the program: ``robot:Arm.move_by``, ``self.time``."""
    if isinstance(data, str):
        is_target = (":" in data or "." in data) and " " not in data and "/" not in data
        return names_in(data) if is_target else set()
    if isinstance(data, Mapping):
        data = [*data.keys(), *data.values()]
    if isinstance(data, list | tuple):
        return {name for one in data for name in _targets(one)}
    return set()


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
    core = (home / part for part in ("model", "operators", "runtime", "campaign", "execution"))
    files = sorted(file for one in (*core, *home.parent.glob("mutabot_*")) for file in one.rglob("*.py"))
    return _digest([(file.relative_to(home.parent).as_posix(), _digest_of(file)) for file in files])
