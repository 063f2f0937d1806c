"""Who notices what in a program, gathered by running, and as a file: one line for each bug or mutant.

Of programs on plain objects, campaigns judge mutants of calls, and forks of one process bugs and mutants of
the text (``matrix``). Of programs on the cell and on ROS 2, which need fixtures and plug-ins of pytest, one
campaign judges all, of each family at most ``ON_ROS`` and ``ON_CELL`` mutants.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from importlib.util import find_spec
from pathlib import Path
from random import Random

from mutabot.campaign.request import Progress
from mutabot.campaign.run import run_campaign
from mutabot.cli.request import request_of
from mutabot.journal.reader import JournalReader
from mutabot.model import Outcome, Role, Verdict
from mutabot.results.results import MutantResult, Results, read_results
from real_bugs.lines import RECORD
from real_bugs.matrix import PROBE, STRENGTHS, Suite, Variant, in_fork

__all__ = ["STRENGTHS"]

PROGRAMS = Path(__file__).resolve().parent / "programs"
BUGS = "patch"
#: mutants of calls, and those of the text; tables of scores have the ``FAMILIES``
OF_CALLS, OF_TEXT = ("robot", "catalogue"), ("bugs", "conventional")
FAMILIES = ("robot", *OF_TEXT)
#: mutants of each family of a program on ROS 2, and of one on the cell, drawn by the campaign's seed
ON_ROS, ON_CELL = 30, 10
KILLED, REFUSED, STILLBORN, DIFFERS, SAME = "killed", "refused", "stillborn", "differs", "same"
#: what programs need that say so in their settings
NEEDED = {"ros_in_process": "rclpy", '"cell"': "mujoco"}
#: what a text raises that makes no sense, wherever it is reached
_SENSELESS = {"NameError", "UnboundLocalError", "AttributeError", "TypeError", "SyntaxError"}
#: the tests that notice a mutant or a bug
Kills = frozenset[str]


class SilentProgress(Progress):
    """A progress that shows nothing."""


@dataclass(frozen=True)
class Noticed:
    """A bug or a mutant, and who notices it.

    Attributes:
        family: its family; ``patch`` for a bug.
        operator: the name of its operator; empty for a bug.
        what: what it is.
        end: ``killed``; ``stillborn``: whatever notices it sees an error of a name or type; ``refused``:
            the robot refuses it; or, where no test notices it, ``differs`` from the original on inputs of the
            probe, or is the ``same`` on all of them. On the cell and on ROS 2, the tests are these inputs: it
            ``differs`` if anything is seen to. Mutants of calls of plain objects are not probed: they are the
            ``same`` if no test notices them.
        by: the tests that notice it.
    """

    family: str
    operator: str
    what: str
    end: str
    by: Kills = frozenset()


@dataclass
class Found:
    """Who notices what in a program.

    Attributes:
        name: the program's.
        tests: all tests.
        lines: of the program, that each test reaches.
        mutants: the bugs and mutants.
    """

    name: str
    tests: list[str]
    lines: dict[str, frozenset[int]]
    mutants: list[Noticed] = field(default_factory=list)
    _kills: dict[tuple[str, ...], tuple[Kills, ...]] = field(default_factory=dict)

    def coverage(self, tests: Kills) -> float:
        """Return the share of the lines that all tests reach that these do."""
        of_all = frozenset().union(*self.lines.values())
        return len(frozenset().union(*(self.lines[test] for test in tests))) / len(of_all)

    def kills(self, families: tuple[str, ...]) -> tuple[Kills, ...]:
        """The tests that notice each bug or mutant of these families that counts."""
        if families not in self._kills:
            counting = (
                mutant for mutant in self.mutants if mutant.family in families and mutant.end != REFUSED
            )
            self._kills[families] = tuple(noticed.by for noticed in counting)
        return self._kills[families]

    def kills_of(self, operator: str) -> tuple[Kills, ...]:
        """The tests that notice each mutant of an operator that counts."""
        return tuple(
            mutant.by for mutant in self.mutants if mutant.operator == operator and mutant.end != REFUSED
        )


def missing(name: str) -> list[str]:
    """Return the packages that a program needs and this Python lacks."""
    settings = "".join((PROGRAMS / name / file).read_text() for file in ("mutabot.toml", "pytest.ini"))
    return [package for word, package in NEEDED.items() if word in settings and find_spec(package) is None]


def gather(name: str, sample: int | None = None) -> Found:
    """Run all tests of a program with each of its bugs and mutants, or so many of each kind of mutants."""
    if not (PROGRAMS / name / f"{PROBE}.py").exists():
        is_ros = (PROGRAMS / name / "robot.toml").exists()
        return of_campaign(name, sample or (ON_ROS if is_ros else ON_CELL))
    calls = of_calls(name, sample)
    found = of_text(name, sample)
    found.mutants += calls
    return found


def of_campaign(name: str, sample: int) -> Found:
    """The bugs of a program on the cell or on ROS 2, and so many mutants of each family."""
    with tempfile.TemporaryDirectory() as folder:
        copy = copied(PROGRAMS / name, Path(folder))
        file = Path(folder).resolve() / "lines.json"
        environment = {**os.environ, "PYTHONPATH": str(PROGRAMS.parents[1]), RECORD: str(file)}
        words = [sys.executable, "-m", "pytest", "-q", "-p", "real_bugs.lines", "-p", "no:cacheprovider"]
        subprocess.run(words, cwd=copy, env=environment, check=True, stdout=subprocess.DEVNULL)
        lines = {test: frozenset(those) for test, those in json.loads(file.read_text()).items()}
        families = [*OF_CALLS, *OF_TEXT, BUGS]
        return Found(name, list(lines), lines, _campaign(copy, families, sample, is_probed=True))


def of_text(name: str, sample: int | None = None) -> Found:
    """The bugs of a program, and the mutants of its text."""
    suite = Suite(PROGRAMS / name)
    lines = {test: frozenset(those) for test, those in suite.lines().items()}
    found = Found(name, [test for test, _ in suite.tests()], lines)
    variants = [*suite.variants(OF_TEXT)]
    bugs, mutants = (
        [variant for variant in variants if (variant.family == BUGS) is is_bug] for is_bug in (True, False)
    )
    if sample is not None:
        mutants = Random(name).sample(mutants, min(sample, len(mutants)))
    found.mutants += [_noticed(suite, bug) for bug in (*bugs, *mutants)]
    return found


def _noticed(suite: Suite, variant: Variant) -> Noticed:
    failures = in_fork(lambda: suite.failures(variant.text))
    is_different = failures.pop(PROBE, None) is not None
    if failures:
        is_senseless = variant.family != BUGS and _SENSELESS.issuperset(failures.values())
        end = STILLBORN if is_senseless else KILLED
    else:
        end = DIFFERS if is_different else SAME
    return Noticed(variant.family, variant.operator, variant.what, end, frozenset(failures))


def of_calls(name: str, sample: int | None = None) -> list[Noticed]:
    """The mutants of the calls in a program, by a campaign with every test."""
    with tempfile.TemporaryDirectory() as folder:
        return _campaign(copied(PROGRAMS / name, Path(folder)), OF_CALLS, sample)


def copied(program: Path, folder: Path) -> Path:
    copy = folder.resolve() / program.name
    shutil.copytree(program, copy, ignore=shutil.ignore_patterns(".mutabot", "__pycache__", ".pytest_cache"))
    return copy


def _campaign(
    folder: Path, families: Sequence[str], sample: int | None, *, is_probed: bool = False
) -> list[Noticed]:
    """Run a campaign with every test; return what became of the mutants that stand in the program."""
    request = request_of(folder, family=[*families], sample=None if sample is None else str(sample))
    request = replace(request, every_test=True)
    with JournalReader.open(run_campaign(request, SilentProgress())) as journal:
        return judged(read_results(journal), is_probed=is_probed)


def judged(results: Results, *, is_probed: bool = False) -> list[Noticed]:
    """What became of the mutants of a campaign with every test that stand in the program, and of patches.

    ``is_probed``: whether the campaign compares the world of survivors with that of the original.
    """
    found = []
    for result in results.mutants:
        mutant, (outcome,) = result.mutant, result.outcomes
        by = noticing(outcome)
        is_judged = outcome.verdict not in (Verdict.ERROR, Verdict.TIMEOUT) or by
        if not is_judged or mutant.site.role is not Role.PROGRAM:
            continue
        if mutant.family == BUGS:
            file, _, title = mutant.description.partition(" ")
            found.append(Noticed(BUGS, "", f"{Path(file).stem}: {title}", _end(result, is_probed), by))
        else:
            what = f"{mutant.site.span.line}: {mutant.description}"
            found.append(Noticed(mutant.family, mutant.operator, what, _end(result, is_probed), by))
    return found


def noticing(outcome: Outcome) -> Kills:
    """The tests that notice it; a command that the robot refuses fails the test that gives it."""
    refusing = {outcome.test} if outcome.verdict is Verdict.REFUSED and outcome.test else set[str]()
    return frozenset({kill.test for kill in outcome.kills} | refusing)


def _end(result: MutantResult, is_probed: bool) -> str:
    (outcome,) = result.outcomes
    if result.mutant.family != BUGS and outcome.verdict in (Verdict.INVALID, Verdict.REFUSED):
        return REFUSED
    if noticing(outcome):
        raised = {(kill.exception or "").rpartition(":")[2] for kill in outcome.kills}
        is_senseless = result.mutant.family in OF_TEXT and bool(raised) and _SENSELESS.issuperset(raised)
        return STILLBORN if is_senseless else KILLED
    is_same = result.indistinguishable or outcome.verdict is Verdict.NO_EFFECT
    return SAME if is_same or not is_probed else DIFFERS


def write(file: Path, programs: Iterable[Found]) -> None:
    """Write who notices what: tests by their numbers, lines as they are."""
    lines = []
    for program in programs:
        numbers = {test: number for number, test in enumerate(program.tests)}
        head = {"tests": program.tests, "lines": [sorted(program.lines[test]) for test in program.tests]}
        rows = [
            [each.family, each.operator, each.what, each.end, sorted(numbers[test] for test in each.by)]
            for each in program.mutants
        ]
        shown = ",\n".join(json.dumps(row, ensure_ascii=False, separators=(",", ":")) for row in rows)
        text = json.dumps(head, ensure_ascii=False, separators=(",", ":"))
        lines.append(f'{json.dumps(program.name)}: {text[:-1]},"mutants":[\n{shown}\n]}}')
    file.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def read(file: Path) -> list[Found]:
    """Read what was written."""
    found = []
    for name, data in json.loads(file.read_text(encoding="utf-8")).items():
        tests: Sequence[str] = data["tests"]
        lines = {test: frozenset(those) for test, those in zip(tests, data["lines"], strict=True)}
        mutants = [
            Noticed(family, operator, what, end, frozenset(tests[number] for number in by))
            for family, operator, what, end, by in data["mutants"]
        ]
        found.append(Found(name, list(tests), lines, mutants))
    return found
