"""Made-up campaigns over several families: every end occurs, and nothing is measured."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path as File
from typing import Any

from mutabot.journal.journal import Journal
from mutabot.model import By, Kill, Mutant, Outcome, Role, Verdict
from mutabot.results.results import Results, read_results
from results import samples

TESTS = tuple(f"tests/test_mission.py::test_{letter}" for letter in "abc")
#: family and role -> number of mutants, and weights of: killed by check, by exception, by exception before
#: any command, survived, indistinguishable, refused, invalid, no effect, not covered, time-out, unstable,
#: error
KINDS = {
    ("robot", Role.PROGRAM): (30, (50, 10, 0, 20, 8, 10, 0, 2, 0, 2, 1, 1)),
    ("robot", Role.ORACLE): (12, (70, 0, 0, 10, 20, 0, 0, 0, 0, 0, 0, 0)),
    ("conventional", Role.PROGRAM): (120, (15, 25, 15, 8, 20, 8, 0, 3, 4, 2, 1, 1)),
    ("text", Role.PROGRAM): (60, (2, 3, 80, 0, 0, 0, 15, 0, 0, 0, 0, 0)),
}


def mutants() -> tuple[Mutant, ...]:
    found: list[Mutant] = []
    for (family, role), (count, _) in KINDS.items():
        for index in range(count):
            file = "mission.py" if role is Role.PROGRAM else "tests/sensors.py"
            at = samples.site(file, 2 + index // 3, "arm.move_by", role, occurrence=index // 3 + 1)
            operation = "robot:Arm.move_by" if family == "robot" else ""
            text = f"{family} mutant {index + 1}"
            found.append(
                Mutant(len(found) + 1, family, f"{family}-{index % 3}", at, operation, None, None, "", text)
            )
    return tuple(found)


def outcomes(*, rounds: int = 3, luck: int = 1, complete: bool = True) -> tuple[Outcome, ...]:
    """Most mutants end alike in all rounds."""
    generator = random.Random(luck)
    found = []
    for mutant in mutants():
        weights = KINDS[mutant.family, mutant.site.role][1]
        usual = generator.choices(range(len(weights)), weights)[0]
        tests = generator.sample(TESTS, generator.choice((1, 2, 3)))
        for round in range(rounds):
            kind = usual if generator.random() < 0.9 else generator.choices(range(len(weights)), weights)[0]
            outcome = _outcome(mutant.id, round, kind, tests)
            found.append(outcome if complete else replace(outcome, complete=False, kills=outcome.kills[:1]))
    return tuple(found)


def _outcome(mutant: str, round: int, kind: int, tests: list[str]) -> Outcome:
    base = Outcome(
        mutant, round, Verdict.SURVIVED, tests=3, wall=0.5, cpu=0.4, simulated=8.0, shared=5.0, complete=True
    )
    if kind <= 2:
        by = By.CHECK if kind == 0 else By.EXCEPTION
        tests = list(TESTS) if kind == 2 else tests
        kills = tuple(Kill(test, by, "builtins:AssertionError", "assert False") for test in tests)
        return replace(
            base, verdict=Verdict.KILLED, by=by, test=tests[0], kills=kills, commands=0 if kind == 2 else 4
        )
    if kind <= 4:
        return replace(base, indistinguishable=kind == 4, distance=0.0 if kind == 4 else 12.0)
    verdict = (
        Verdict.REFUSED, Verdict.INVALID, Verdict.NO_EFFECT, Verdict.NOT_COVERED, Verdict.TIMEOUT,
        Verdict.UNSTABLE, Verdict.ERROR,
    )[kind - 5]  # fmt: skip
    return replace(base, verdict=verdict, test=tests[0] if verdict is Verdict.TIMEOUT else None)


def write(path: File, *, rounds: int = 3, luck: int = 1, complete: bool = True, **meta: Any) -> File:
    """The journal of such a campaign."""
    facts = {"families": ["robot", "conventional", "text"], "every_test": True, **meta}
    return samples.write_journal(
        path,
        mutants=mutants(),
        outcomes=outcomes(rounds=rounds, luck=luck, complete=complete),
        rounds=rounds,
        **facts,
    )


def read(path: File) -> Results:
    with Journal.open(path) as journal:
        return read_results(journal)
