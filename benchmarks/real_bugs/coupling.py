"""What suites that kill more mutants catch of the bugs of ``programs``, and whether mutants stand for bugs.

Each program of ``programs`` is right, has suites of three strengths, and patches, each of which plants a bug
as it was found in public robot programs. All tests run with every bug and every mutant. Asked is

* which bugs and which share of the mutants of each family each suite notices;
* whether, of many random parts of a program's tests, all of one size, those that kill more mutants catch more
  bugs: the rank correlation (Spearman), beside that of the lines covered;
* for how many bugs there is a mutant that is killed by exactly the tests that catch the bug;
* how many dominators there are: classes of mutants that no other one subsumes (``mutabot_minimal``);
* which share of the bugs parts of any size catch that have some score: what reports say beside a score
  (``mutabot.results.bugs_caught``).

Intervals are those of 2000 draws of programs with replacement (bootstrap, 95 %).

Use: ``python benchmarks/real_bugs/coupling.py [NAMES] [--json FILE | --read FILE]``, with a Python that has
ROS 2 and MuJoCo.
"""

from __future__ import annotations

import argparse
import multiprocessing
import random
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import TypeVar

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from mutabot.results.bugs_caught import Caught, band_of
from mutabot_minimal.subsumption import dominators
from real_bugs.gathering import BUGS, FAMILIES, PROGRAMS, STRENGTHS, Found, gather, missing, read, write

#: what a score may be made of
GROUPS: Mapping[str, tuple[str, ...]] = {
    "robot": ("robot",),
    "bugs": ("bugs",),
    "conventional": ("conventional",),
    "robot, bugs": ("robot", "bugs"),
    "robot, bugs, conventional": ("robot", "bugs", "conventional"),
}
LINES = "lines covered"
#: scores that are compared
COMPARED = (
    ("robot", "conventional"), ("bugs", "conventional"), ("robot, bugs, conventional", "conventional"),
    ("robot, bugs", "robot"), ("robot, bugs, conventional", "robot"),
    ("robot, bugs, conventional", "robot, bugs"), ("robot, bugs", LINES), ("conventional", LINES),
)  # fmt: skip
PARTS, DRAWS, SEED = 400, 2000, 1
#: mutants and programs that an operator must have to be looked at by itself
MUTANTS, OF_PROGRAMS = 20, 4
T = TypeVar("T")
#: what makes a table of programs, line by line
Table = Callable[[Sequence[Found]], Iterable[str]]


def command_line(description: str | None) -> argparse.ArgumentParser:
    """Return a parser of what scripts are told that run programs or read what was written of them."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", help="programs; all without")
    parser.add_argument("--json", type=Path, help="where to write who notices what")
    parser.add_argument("--read", type=Path, help="what was written so, instead of running anything")
    parser.add_argument("--jobs", type=int, default=2, help="programs at a time")
    return parser


def main() -> int:
    """The command."""
    parser = command_line(__doc__)
    parser.add_argument("--sample", type=int, help="so many mutants of calls and of text of each")
    given = parser.parse_args()
    if given.read is not None:
        programs = read(given.read)
    else:
        names = given.names or sorted(
            path.name for path in PROGRAMS.iterdir() if (path / "program.py").exists()
        )
        if lacking := {name: needed for name in names if (needed := missing(name))}:
            parser.error(f"this Python lacks what these programs need: {lacking}; --read does without")
        with multiprocessing.get_context("fork").Pool(given.jobs, maxtasksperchild=1) as pool:
            programs = pool.starmap(gather, [(name, given.sample) for name in names], chunksize=1)
    if given.json is not None:
        write(given.json, programs)
    for part in (of_suites, of_parts, of_coupling, of_operators, of_minimal, of_scores):
        print("\n".join([*part(programs), ""]))
    return 0


def of_suites(programs: Sequence[Found]) -> Iterable[str]:
    """Which bugs and mutants each suite notices."""
    yield f"| suite | bugs | {' | '.join(FAMILIES)} |"
    yield "|---" * (2 + len(FAMILIES)) + "|"
    for number, name in enumerate(STRENGTHS):
        suites = tuple(f"test_{strength}.py" for strength in STRENGTHS[: number + 1])
        shares = []
        for family in (BUGS, *FAMILIES):
            caught = [
                any(suite in test for test in kills for suite in suites)
                for program in programs
                for kills in program.kills((family,))
            ]
            shares.append(f"{sum(caught)} of {len(caught)} = {100 * fmean(caught or [0]):.0f} %")
        yield f"| {name} | {' | '.join(shares)} |"


@dataclass(frozen=True)
class Parts:
    """Random parts of a program's tests, all of one size, and the bugs that each catches."""

    found: Found
    tests: tuple[frozenset[str], ...]
    bugs: tuple[float, ...]

    @classmethod
    def of(cls, found: Found, share: float) -> Parts:
        """Draw them; ``share``: of the tests."""
        draw = random.Random(SEED)
        size = max(2, round(share * len(found.tests)))
        tests = tuple(frozenset(draw.sample(found.tests, size)) for _ in range(PARTS))
        return cls(found, tests, tuple(noticed(found.kills((BUGS,)), test) for test in tests))

    def correlation(self, score: Callable[[frozenset[str]], float]) -> float:
        """Return the rank correlation of a score of the parts with the bugs that they catch."""
        return spearman([score(test) for test in self.tests], self.bugs)


def of_parts(programs: Sequence[Found]) -> Iterable[str]:
    """Whether parts that kill more mutants, or cover more lines, catch more bugs."""
    quarter, half = ([Parts.of(program, share) for program in programs] for share in (0.25, 0.5))
    by = {name: (_correlations(quarter, own), _correlations(half, own)) for name, own in GROUPS.items()}
    by[LINES] = (
        [parts.correlation(parts.found.coverage) for parts in quarter],
        [parts.correlation(parts.found.coverage) for parts in half],
    )
    yield "| score | a quarter of the tests | a half | programs with a positive correlation (half) |"
    yield "|---|---|---|---|"
    for name, (of_quarter, of_half) in by.items():
        positive = sum(value > 0 for value in of_half)
        yield f"| {name} | {in_words(of_quarter)} | {in_words(of_half)} | {positive} of {len(of_half)} |"
    yield from ("", "| difference | a quarter of the tests | a half |", "|---|---|---|")
    for first, second in COMPARED:
        pairs = zip(by[first], by[second], strict=True)
        gaps = [[a - b for a, b in zip(*pair, strict=True)] for pair in pairs]
        yield f"| {first} – {second} | {' | '.join(map(in_words, gaps))} |"


def _correlations(parts: Iterable[Parts], families: tuple[str, ...]) -> list[float]:
    return [_correlation(part, part.found.kills(families)) for part in parts]


def _correlation(part: Parts, kills: Sequence[frozenset[str]]) -> float:
    return part.correlation(lambda tests: noticed(kills, tests))


def of_coupling(programs: Sequence[Found]) -> Iterable[str]:
    """For how many bugs there is a mutant that is killed by exactly the tests that catch it."""
    yield "| family | bugs that are caught and have a mutant killed by exactly the same tests |"
    yield "|---|---|"
    for name, families in GROUPS.items():
        yield coupled_row(name, [(program, program.kills(families)) for program in programs])


def coupled_row(name: str, programs: Sequence[tuple[Found, Sequence[frozenset[str]]]]) -> str:
    """Return for how many bugs of programs something is noticed by exactly the same tests."""
    by_program = [[tests in kills for tests in found.kills((BUGS,)) if tests] for found, kills in programs]
    rows = [row for row in by_program if row]
    low, high = interval(rows, _share)
    count, size = sum(map(sum, rows)), sum(map(len, rows))
    share = f"{count} of {size} = {100 * count / size:.0f} %"
    return f"| {name} | {share} ({100 * low:.0f}–{100 * high:.0f}) |"


def _share(rows: Sequence[Sequence[bool]]) -> float:
    return sum(map(sum, rows)) / sum(map(len, rows))


def of_operators(programs: Sequence[Found]) -> Iterable[str]:
    """Which operators' kills go with bugs caught."""
    yield "| operator | mutants | rank correlation (half) | killed by exactly the tests that catch a bug |"
    yield "|---|---|---|---|"
    half = [Parts.of(program, 0.5) for program in programs]
    rows = []
    names = {mutant.operator for found in programs for mutant in found.mutants if mutant.operator}
    for name in sorted(names):
        having = [part for part in half if part.found.kills_of(name)]
        kills = [(part, tests) for part in having for tests in part.found.kills_of(name)]
        if len(kills) < MUTANTS or len(having) < OF_PROGRAMS:
            continue
        correlations = [_correlation(part, part.found.kills_of(name)) for part in having]
        coupled = [tests in part.found.kills((BUGS,)) for part, tests in kills if tests]
        row = f"| {name} | {len(kills)} | {in_words(correlations)} | {100 * fmean(coupled or [0]):.0f} % |"
        rows.append((fmean(correlations), row))
    yield from (row for _, row in sorted(rows, reverse=True))


def of_minimal(programs: Sequence[Found]) -> Iterable[str]:
    """How many mutants are left of each group once subsumed ones are gone."""
    yield "| family | mutants | killed | dominators |"
    yield "|---|---|---|---|"
    for name, families in GROUPS.items():
        kills = [program.kills(families) for program in programs]
        killed = sum(bool(tests) for row in kills for tests in row)
        left = sum(len(dominators(_with_rounds(row))) for row in kills)
        yield f"| {name} | {sum(map(len, kills))} | {killed} | {left} |"


def _with_rounds(kills: Sequence[frozenset[str]]) -> dict[int, frozenset[tuple[str, int]]]:
    return {number: frozenset((test, 0) for test in tests) for number, tests in enumerate(kills)}


def of_scores(programs: Sequence[Found]) -> Iterable[str]:
    """Which share of the bugs parts of any size catch that have some score."""
    yield "| score of the part | robot | bugs | conventional |"
    yield "|---|---|---|---|"
    columns = [bands(programs, family) for family in FAMILIES]
    for band, row in enumerate(zip(*columns, strict=True)):
        yield f"| {20 * band}–{20 * band + 20} % | {' | '.join(map(_cell, row))} |"


def _cell(caught: Caught | None) -> str:
    """Return what is caught as a cell of the table; a dash where no part has such a score."""
    if caught is None:
        return "–"
    return f"{caught.mean} % ({caught.low}–{caught.high}; {caught.programs} programs)"


def bands(programs: Sequence[Found], family: str) -> tuple[Caught | None, ...]:
    """Return what parts with scores of each band catch, over programs; None where no part has such a score.

    Of each program as many parts are drawn, of sizes that are drawn evenly from one test to all.
    """
    found: list[dict[str, list[float]]] = [{} for _ in range(5)]
    for program in programs:
        draw = random.Random(SEED)
        kills, bugs = program.kills((family,)), program.kills((BUGS,))
        for _ in range(PARTS):
            tests = frozenset(draw.sample(program.tests, draw.randint(1, len(program.tests))))
            band = found[band_of(noticed(kills, tests))]
            band.setdefault(program.name, []).append(noticed(bugs, tests))
    return tuple(_caught(by_program) if by_program else None for by_program in found)


def _caught(by_program: Mapping[str, Sequence[float]]) -> Caught:
    shares = sorted(share for own in by_program.values() for share in own)
    low, high = shares[len(shares) // 10], shares[len(shares) * 9 // 10]
    mean = fmean(map(fmean, by_program.values()))
    return Caught(len(by_program), round(100 * mean), round(100 * low), round(100 * high))


def noticed(kills: Sequence[frozenset[str]], tests: frozenset[str]) -> float:
    """Return the share of bugs or mutants that these tests notice; 0 if there are none."""
    return sum(not kill.isdisjoint(tests) for kill in kills) / len(kills) if kills else 0.0


def interval(rows: Sequence[T], mean: Callable[[Sequence[T]], float]) -> tuple[float, float]:
    """Return the 95 % interval of a mean over programs, which are drawn with replacement."""
    draw = random.Random(SEED)
    found = sorted(mean(draw.choices(rows, k=len(rows))) for _ in range(DRAWS))
    return found[int(0.025 * DRAWS)], found[int(0.975 * DRAWS) - 1]


def in_words(values: Sequence[float]) -> str:
    """Return the mean over programs with its interval."""
    low, high = interval(values, fmean)
    return f"{fmean(values):.2f} ({low:.2f} to {high:.2f})"


def spearman(left: Sequence[float], right: Sequence[float]) -> float:
    """Return the rank correlation of two rows; 0 if all values of a row are equal."""
    first, second = _ranks(left), _ranks(right)
    middle = (len(left) + 1) / 2
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
