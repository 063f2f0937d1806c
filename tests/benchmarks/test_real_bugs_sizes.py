"""What has sizes beside the real bugs: who notices disturbances and graded faults, and what that adds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path

import pytest

from mutabot.model import By, Kill, Mutant, Outcome, Role, Site, Verdict
from mutabot.operators.magnitudes import LADDERS
from mutabot.results.results import MutantResult, Results
from mutabot.results.score import RoundScores
from real_bugs import added
from real_bugs.added import SIZES, counted, joined, score, with_mutants
from real_bugs.gathering import BUGS, DIFFERS, KILLED, REFUSED, SAME, Found, Noticed, read
from real_bugs.rates import DATA
from real_bugs.sizes import AT, GRADED, WORLD, disturbances, graded_noticed, world_noticed
from tests.results import samples

PAGE = (Path(__file__).parents[2] / "docs" / "real-bugs.md").read_text(encoding="utf-8")
FOUND = read(SIZES)


def _results(ended: Sequence[tuple[Mutant, Outcome]]) -> Results:
    graded = tuple(MutantResult(mutant, (outcome,), None, "") for mutant, outcome in ended)
    return Results({}, "complete", 1, (), (), RoundScores.of([], 1), (), (), (), graded=graded)


def _disturbed(test: str, parameter: str) -> Mutant:
    site = Site.of_parameter(test, parameter)
    return Mutant(
        1, WORLD, "disturb", site, "", None, None, "+5mm", "", magnitude=5.0, unit="mm", has_sizes=True
    )


_KILLED = Outcome("", 0, Verdict.KILLED, kills=(Kill("t1", By.CHECK),))
_AS_BEFORE = Outcome("", 0, Verdict.SURVIVED, indistinguishable=True)
_ELSEWHERE = Outcome("", 0, Verdict.SURVIVED, indistinguishable=False, distance=3.0)
_REFUSED = Outcome("", 0, Verdict.REFUSED, test="t1")
_NOTHING = Outcome("", 0, Verdict.NO_EFFECT)


@pytest.mark.parametrize(
    ("first", "second", "end", "by"),
    [
        (_KILLED, _AS_BEFORE, KILLED, {"t1"}),
        (_REFUSED, _AS_BEFORE, KILLED, {"t1"}),
        (_AS_BEFORE, _ELSEWHERE, DIFFERS, set()),
        (_AS_BEFORE, _AS_BEFORE, SAME, set()),
        (_AS_BEFORE, _NOTHING, SAME, set()),
    ],
)
def test_a_disturbance_is_one_over_all_tests(first: Outcome, second: Outcome, end: str, by: set[str]) -> None:
    results = _results([(_disturbed("t1", "part x"), first), (_disturbed("t2", "part x"), second)])
    assert world_noticed(results) == [Noticed(WORLD, "part x", "+5mm", end, frozenset(by))]


def test_what_disturbs_no_test_is_left_out() -> None:
    assert not world_noticed(_results([(_disturbed("t1", "vacuum leak"), _NOTHING)]))


def test_a_magnitude_has_its_ladder_and_who_notices_it() -> None:
    at = samples.site("program.py", 2, "arm.move_by", Role.PROGRAM)
    mutant = Mutant(
        1, GRADED, "offset", at, "", None, "x", "+5mm", "", magnitude=5.0, unit="mm", direction="+",
        has_sizes=True,
    )  # fmt: skip
    oracle = replace(mutant, site=replace(at, role=Role.ORACLE))
    results = _results([(mutant, _KILLED), (mutant, _REFUSED), (mutant, _AS_BEFORE), (oracle, _KILLED)])
    found = graded_noticed(results)
    assert [(each.end, each.by) for each in found] == [(KILLED, {"t1"}), (REFUSED, {"t1"}), (SAME, set())]
    assert {each.what for each in found} == {f"{mutant.ladder}{AT}5 mm"}


def _magnitude(ladder: str, size: int, by: str, end: str = KILLED) -> Noticed:
    return Noticed(GRADED, "offset", f"{ladder}{AT}{size} mm", end, frozenset(by))


def test_a_score_of_thresholds_is_the_mean_over_ladders() -> None:
    first = [_magnitude("one", 1, ""), _magnitude("one", 2, "b"), _magnitude("one", 5, "ab")]
    second = [_magnitude("two", 1, "a"), _magnitude("two", 2, "ab", REFUSED)]
    units = counted(Found("base", ["a", "b"], {}, [*first, *second]), GRADED)
    assert [len(unit) for unit in units] == [3, 1]
    assert score(units, frozenset("a")) == pytest.approx((1 / 3 + 1) / 2)
    assert score(units, frozenset("b")) == pytest.approx((2 / 3 + 0) / 2)
    assert score((), frozenset("a")) == 0.0


def test_a_disturbance_that_changes_nothing_is_in_no_score() -> None:
    ends = [Noticed(WORLD, "belt speed", "+1%", SAME), Noticed(WORLD, "part x", "+1mm", DIFFERS)]
    assert counted(Found("base", ["a"], {}, ends), WORLD) == [[frozenset()]]


def test_what_has_sizes_stands_beside_the_bugs_and_programs_without_are_left_out() -> None:
    bug, own = Noticed(BUGS, "", "late: order: too late", KILLED), Noticed(WORLD, "part x", "+1mm", DIFFERS)
    programs = [Found("base", ["a"], {}, [bug]), Found("other", ["a"], {}, [bug])]
    (found,) = joined(WORLD, programs, [with_mutants(programs[0], [own])])
    assert (found.name, found.mutants) == ("base", [bug, own])


def test_the_data_have_the_disturbances_that_are_drawn() -> None:
    of_world = {program.name: program for program in FOUND if counted(program, WORLD)}
    assert set(of_world) == {"gauge", "lifter", "tour"}
    for name, program in of_world.items():
        known = {(each.operator, each.what) for each in program.mutants if each.family == WORLD}
        assert known <= set(disturbances(name))


def test_the_data_have_whole_ladders() -> None:
    sizes = {len(steps.steps) for steps in LADDERS.values()}
    for program in FOUND:
        ladders = sorted(each.what.rpartition(AT)[0] for each in program.mutants if each.family == GRADED)
        assert {len([*those]) for _, those in groupby(ladders)} <= sizes


@pytest.mark.parametrize("family", [WORLD, GRADED])
def test_the_page_has_the_tables_of_what_has_sizes(family: str) -> None:
    programs = joined(family, read(DATA), FOUND)
    for part in (added.of_parts, added.of_programs, added.of_coupling):
        assert "\n".join(part(family, programs)) in PAGE
