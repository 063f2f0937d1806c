"""What disturbances of the world and thresholds of graded faults add to the score of robot mutants.

* A score of disturbances is the share of them that is noticed, of those that some test notices or with which
  the world ends otherwise.
* Of a ladder, a part of a suite has the share of the magnitudes that it notices: all if it notices the least
  one, none if it misses the greatest. A score of thresholds is the mean over ladders.
* A score of robot mutants and of these has each mutant, each disturbance and each ladder once.

Asked of each is what ``coupling`` asks of families, in the programs that have some of it; the bugs and the
robot mutants are those of ``coupling.json``.

Use: ``python benchmarks/real_bugs/added.py [NAMES] [--json FILE | --read FILE]``, with a Python that has
MuJoCo.
"""

from __future__ import annotations

import multiprocessing
import sys
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import groupby
from pathlib import Path
from statistics import fmean

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from real_bugs.coupling import Parts, command_line, coupled_row, in_words, noticed
from real_bugs.gathering import BUGS, REFUSED, SAME, Found, Kills, Noticed, read, write
from real_bugs.rates import DATA
from real_bugs.sizes import AT, GRADED, WORLD, with_sizes

#: what was written of all programs
SIZES = Path(__file__).with_name("sizes.json")
ROBOT = "robot"
#: what a score counts as one: a mutant, a disturbance, a ladder; of a ladder, who notices each magnitude
Counted = Sequence[Sequence[Kills]]


def main() -> int:
    """The command."""
    parser = command_line(__doc__)
    given = parser.parse_args()
    known = read(DATA)
    if unknown := {*given.names}.difference(program.name for program in known):
        parser.error(f"no program {', '.join(sorted(unknown))}; there are {', '.join(p.name for p in known)}")
    programs = [program for program in known if not given.names or program.name in given.names]
    if given.read is not None:
        sizes = read(given.read)
    else:
        with multiprocessing.get_context("fork").Pool(given.jobs, maxtasksperchild=1) as pool:
            rows = pool.map(with_sizes, [program.name for program in programs], chunksize=1)
        sizes = [with_mutants(*pair) for pair in zip(programs, rows, strict=True) if pair[1]]
    if given.json is not None:
        write(given.json, sizes)
    for family in (WORLD, GRADED):
        if having := joined(family, programs, sizes):
            for part in (of_parts, of_programs, of_coupling):
                print("\n".join([*part(family, having), ""]))
    return 0


def with_mutants(program: Found, mutants: Sequence[Noticed]) -> Found:
    """Return a program with other mutants."""
    return Found(program.name, program.tests, program.lines, [*mutants])


def joined(family: str, programs: Sequence[Found], sizes: Sequence[Found]) -> list[Found]:
    """Return the programs that have some of a family, with what has sizes beside their bugs and mutants."""
    rows = {found.name: found.mutants for found in sizes}
    whole = (with_mutants(each, [*each.mutants, *rows.get(each.name, ())]) for each in programs)
    return [program for program in whole if counted(program, family)]


def counted(program: Found, family: str) -> Counted:
    """Return what a score of a family counts."""
    if family == WORLD:
        return [[each.by] for each in program.mutants if each.family == WORLD and each.end != SAME]
    if family == GRADED:
        rungs = [each for each in program.mutants if each.family == GRADED and each.end != REFUSED]
        by_ladder = groupby(sorted(rungs, key=_ladder), _ladder)
        return [[each.by for each in those] for _, those in by_ladder]
    return [[kills] for kills in program.kills((family,))]


def _ladder(magnitude: Noticed) -> str:
    return magnitude.what.rpartition(AT)[0]


def score(units: Counted, tests: Kills) -> float:
    """Return the mean over units of the share of each that these tests notice; 0 if there are none."""
    return fmean(noticed(unit, tests) for unit in units) if units else 0.0


def scores(family: str, program: Found) -> Mapping[str, Counted]:
    """Return what each score counts that is compared for a family."""
    robot, own = counted(program, ROBOT), counted(program, family)
    return {ROBOT: robot, family: own, f"{ROBOT}, {family}": [*robot, *own]}


def of_parts(family: str, programs: Sequence[Found]) -> Iterable[str]:
    """Whether parts with a higher score catch more bugs, and more so than by robot mutants alone."""
    quarter, half = ([correlations(family, program, share) for program in programs] for share in (0.25, 0.5))
    yield "| score | a quarter of the tests | a half | programs with a positive correlation (half) |"
    yield "|---|---|---|---|"
    names = (ROBOT, family, f"{ROBOT}, {family}")
    for name in names:
        positive = sum(by[name] > 0 for by in half)
        shown = " | ".join(in_words([by[name] for by in size]) for size in (quarter, half))
        yield f"| {name} | {shown} | {positive} of {len(half)} |"
    for name in names[1:]:
        gaps = ([by[name] - by[ROBOT] for by in size] for size in (quarter, half))
        more = sum(by[name] > by[ROBOT] for by in half)
        yield f"| {name} – {ROBOT} | {' | '.join(map(in_words, gaps))} | {more} of {len(half)} |"


def correlations(family: str, program: Found, share: float) -> Mapping[str, float]:
    """Return the rank correlation of each score with the bugs caught, in parts of one size."""
    parts = Parts.of(program, share)
    return {name: parts.correlation(partial(score, own)) for name, own in scores(family, program).items()}


def of_programs(family: str, programs: Sequence[Found]) -> Iterable[str]:
    """What there is of a family in each program, what the whole suite notices of it, and its correlation."""
    yield "| program | bugs caught | noticed | correlation (half): robot | of the family | both |"
    yield "|---|---|---|---|---|---|"
    for program in programs:
        own, bugs = counted(program, family), program.kills((BUGS,))
        caught = f"{sum(map(bool, bugs))} of {len(bugs)}"
        whole = f"{100 * score(own, frozenset(program.tests)):.0f} % of {len(own)}"
        shown = " | ".join(f"{value:.2f}" for value in correlations(family, program, 0.5).values())
        yield f"| {program.name} | {caught} | {whole} | {shown} |"


def of_coupling(family: str, programs: Sequence[Found]) -> Iterable[str]:
    """For how many bugs something of a family is noticed by exactly the tests that catch the bug."""
    yield "| family | bugs that are caught and have one that exactly the same tests notice |"
    yield "|---|---|"
    for name in (ROBOT, family, f"{ROBOT}, {family}"):
        units = [(program, scores(family, program)[name]) for program in programs]
        yield coupled_row(
            name, [(program, [kills for unit in own for kills in unit]) for program, own in units]
        )


if __name__ == "__main__":
    sys.exit(main())
