"""Who notices what in a program, gathered by running, and as a file: one line for each bug or mutant."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from random import Random

from mutabot.campaign.request import Progress
from mutabot.campaign.run import run_campaign
from mutabot.cli.request import request_of
from mutabot.journal.reader import JournalReader
from mutabot.model import Role, Verdict
from mutabot.results.results import Results, read_results
from real_bugs.matrix import PROBE, STRENGTHS, Suite, Variant, in_fork

__all__ = ["STRENGTHS"]

PROGRAMS = Path(__file__).resolve().parent / "programs"
BUGS = "patch"
#: mutants of calls are judged by campaigns, those of the text beside the bugs
OF_CALLS, OF_TEXT = ("robot",), ("bugs", "conventional")
FAMILIES = (*OF_CALLS, *OF_TEXT)
KILLED, REFUSED, STILLBORN, DIFFERS, SAME = "killed", "refused", "stillborn", "differs", "same"
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
            probe, or is the ``same`` on all of them. Mutants of calls are not probed: they are the ``same``
            if no test notices them.
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


def gather(name: str, sample: int | None = None) -> Found:
    """Run all tests of a program with each of its bugs and mutants, or so many of each kind of mutants."""
    calls = of_calls(name, sample)
    found = of_text(name, sample)
    found.mutants += calls
    return found


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
    program = PROGRAMS / name
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder).resolve() / program.name
        ignored = shutil.ignore_patterns(".mutabot", "__pycache__", ".pytest_cache", "patches")
        shutil.copytree(program, copy, ignore=ignored)
        request = request_of(copy, family=[*OF_CALLS], sample=None if sample is None else str(sample))
        request = replace(request, every_test=True)
        with JournalReader.open(run_campaign(request, SilentProgress())) as journal:
            return judged(read_results(journal))


def judged(results: Results) -> list[Noticed]:
    """The mutants of calls of a campaign with every test that stand in the program."""
    found = []
    for result in results.mutants:
        (outcome,) = result.outcomes
        by = frozenset(kill.test for kill in outcome.kills)
        end = REFUSED if outcome.verdict is Verdict.INVALID else KILLED if by else SAME
        is_judged = outcome.verdict not in (Verdict.ERROR, Verdict.TIMEOUT) or by
        if result.mutant.family in OF_CALLS and result.mutant.site.role is Role.PROGRAM and is_judged:
            what = f"{result.mutant.site.span.line}: {result.mutant.description}"
            found.append(Noticed(result.mutant.family, result.mutant.operator, what, end, by))
    return found


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
