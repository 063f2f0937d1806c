"""What suites that kill more mutants catch of the bugs of ``programs``, and whether mutants stand for bugs.

Each program of ``programs`` is right, has suites of three strengths, and patches, each of which plants a bug
as it was found in public robot programs. All tests run with every bug and every mutant. Asked is

* which bugs and which share of the mutants of each family each suite notices;
* whether a random half of a program's tests that kills more mutants catches more bugs: the rank correlation
  (Spearman) over many halves of the same size, so that more tests are no reason;
* for how many bugs there is a mutant that is killed by exactly the tests that catch the bug.

Use: ``python benchmarks/real_bugs/coupling.py [--json FILE]``. Takes a few minutes.
"""

from __future__ import annotations

import argparse
import json
import random
import shutil
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean

from mutabot.campaign.request import Progress
from mutabot.campaign.run import run_campaign
from mutabot.cli.request import request_of
from mutabot.journal.reader import JournalReader
from mutabot.model import Verdict
from mutabot.results.results import read_results

ROOT = Path(__file__).resolve().parent


PROGRAMS = ROOT / "programs"
BUGS = "patch"
FAMILIES = ("robot", "bugs", "conventional")
STRENGTHS = ("weak", "medium", "strong")
HALVES, SEED = 1000, 1
#: the tests that notice a mutant or a bug
Kills = frozenset[str]


class SilentProgress(Progress):
    """A progress that shows nothing."""


@dataclass(frozen=True)
class KillMatrix:
    """Who notices what in a program.

    Attributes:
        tests: all tests.
        kills: by family, the tests that notice each mutant that counts, by its number and description.
    """

    tests: tuple[str, ...]
    kills: Mapping[str, Mapping[str, Kills]]

    @classmethod
    def of(cls, data: Mapping[str, Mapping[str, Sequence[str]]]) -> KillMatrix:
        """Return what plain data says."""
        kills = {
            family: {what: frozenset(by) for what, by in mutants.items()} for family, mutants in data.items()
        }
        tests = {test for mutants in kills.values() for by in mutants.values() for test in by}
        return cls(tuple(sorted(tests)), kills)

    def score(self, family: str, tests: Kills) -> float:
        """Return the share of the mutants of a family that these tests notice."""
        found = self.kills[family].values()
        return fmean(bool(one & tests) for one in found) if found else 0.0


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", help="programs; all without")
    parser.add_argument("--json", type=Path, help="where to write who notices what")
    parser.add_argument("--read", type=Path, help="what was written so, instead of running anything")
    given = parser.parse_args()
    if given.read is not None:
        data = json.loads(given.read.read_text(encoding="utf-8"))
    else:
        programs = sorted(one for one in PROGRAMS.iterdir() if (one / "mutabot.toml").exists())
        data = {one.name: run(one) for one in programs if not given.names or one.name in given.names}
    if given.json is not None:
        given.json.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    found = {name: KillMatrix.of(one) for name, one in data.items()}
    print(_of_suites([*found.values()]))
    print(_of_halves([*found.values()]))
    print(_of_coupling([*found.values()]))
    return 0


def run(program: Path) -> dict[str, dict[str, list[str]]]:
    """Run all tests of a program with each of its bugs and mutants; return by family who notices which."""
    with tempfile.TemporaryDirectory() as name:
        copy = Path(name).resolve() / program.name
        ignored = shutil.ignore_patterns(".mutabot", "__pycache__", ".pytest_cache")
        shutil.copytree(program, copy, ignore=ignored)
        request = replace(request_of(copy, family=[BUGS, *FAMILIES]), every_test=True)
        with JournalReader.open(run_campaign(request, SilentProgress())) as journal:
            results = read_results(journal)
    found: dict[str, dict[str, list[str]]] = {family: {} for family in (BUGS, *FAMILIES)}
    for one in results.mutants:
        (outcome,) = one.outcomes
        if outcome.verdict in (Verdict.KILLED, Verdict.TIMEOUT, Verdict.SURVIVED, Verdict.NOT_COVERED):
            named = f"{one.mutant.number} {one.mutant.operator}: {one.mutant.description}"
            found[one.mutant.family][named] = sorted({kill.test for kill in outcome.kills})
    return found


def _of_suites(found: Sequence[KillMatrix]) -> str:
    lines = [f"| suite | bugs | {' | '.join(FAMILIES)} |", "|---" * (2 + len(FAMILIES)) + "|"]
    for number, name in enumerate(STRENGTHS):
        words = tuple(f"test_{one}.py" for one in STRENGTHS[: number + 1])
        shares = []
        for family in (BUGS, *FAMILIES):
            caught = [
                any(word in test for test in kills for word in words)
                for one in found
                for kills in one.kills[family].values()
            ]
            shares.append(f"{sum(caught)} of {len(caught)} = {100 * fmean(caught):.0f} %")
        lines.append(f"| {name} | {' | '.join(shares)} |")
    return "\n".join([*lines, ""])


def _of_halves(found: Sequence[KillMatrix]) -> str:
    draw = random.Random(SEED)
    halves = [
        [frozenset(draw.sample(one.tests, len(one.tests) // 2)) for _ in range(HALVES)] for one in found
    ]
    lines = ["| family | rank correlation with bugs caught, by program | mean |", "|---|---|---|"]
    for family in FAMILIES:
        ranks = [
            spearman([one.score(family, half) for half in own], [one.score(BUGS, half) for half in own])
            for one, own in zip(found, halves, strict=True)
        ]
        shown = ", ".join(f"{one:.2f}" for one in ranks)
        lines.append(f"| {family} | {shown} | {fmean(ranks):.2f} |")
    return "\n".join([*lines, ""])


def _of_coupling(found: Sequence[KillMatrix]) -> str:
    lines = [
        "| family | bugs that are caught and have a mutant killed by exactly the same tests |",
        "|---|---|",
    ]
    for families in (*((one,) for one in FAMILIES), FAMILIES):
        coupled = [
            any(tests in one.kills[family].values() for family in families)
            for one in found
            for tests in one.kills[BUGS].values()
            if tests
        ]
        lines.append(f"| {', '.join(families)} | {sum(coupled)} of {len(coupled)} |")
    return "\n".join(lines)


def spearman(one: Sequence[float], other: Sequence[float]) -> float:
    """Return the rank correlation of two rows; 0 if all values of a row are equal."""
    first, second = _ranks(one), _ranks(other)
    middle = (len(one) + 1) / 2
    spread = [sum((rank - middle) ** 2 for rank in ranks) ** 0.5 for ranks in (first, second)]
    product = sum((a - middle) * (b - middle) for a, b in zip(first, second, strict=True))
    return product / (spread[0] * spread[1]) if all(spread) else 0.0


def _ranks(values: Sequence[float]) -> list[float]:
    """Ranks from 1; equal values share the mean of theirs."""
    places: dict[float, list[int]] = {}
    for place, value in enumerate(sorted(values), start=1):
        places.setdefault(value, []).append(place)
    return [fmean(places[value]) for value in values]


if __name__ == "__main__":
    sys.exit(main())
