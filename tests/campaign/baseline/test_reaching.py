"""Which tests reach a place: in order, without those set aside, and in little memory for long suites."""

from __future__ import annotations

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.model.events import TestEnd
from mutabot.model.mutant import Place, Role, Site, Span

SUITE = ["slow", "quick", "flaky", "middle"]
OPERATIONS = {"slow": 9, "quick": 1, "flaky": 2, "middle": 5}


def place(line: int) -> Place:
    return Place(Site(Span("program.py", line, 0, line, 4, "run"), "go()", 1, Role.PROGRAM), "robot:go")


def known() -> Baseline:
    ends = {(0, test): TestEnd(test, "passed", operations=OPERATIONS[test]) for test in SUITE}
    return Baseline(tests=[list(SUITE)], ends=ends)


def test_the_quickest_come_first() -> None:
    baseline = known()
    baseline.reach(0, place(1), {"middle", "slow", "quick"})
    assert baseline.reaching[0, place(1)] == ("quick", "middle", "slow")
    baseline.reach(0, place(2), None)
    assert baseline.reaching[0, place(2)] == ("quick", "flaky", "middle", "slow")


def test_places_that_the_same_tests_reach_share_one_list() -> None:
    baseline = known()
    for line in range(1, 4):
        baseline.reach(0, place(line), ["slow", "quick"] if line % 2 else ("quick", "slow"))
    assert len({id(tests) for tests in baseline.reaching.values()}) == 1


def test_a_test_that_is_set_aside_later_judges_nowhere_and_is_remembered_everywhere() -> None:
    baseline = known()
    baseline.set_aside(0, "middle", "failed once")
    baseline.reach(0, place(1), None)
    baseline.reach(0, place(2), {"quick", "slow"})
    baseline.set_aside(0, "flaky", "failed once")
    assert baseline.reaching[0, place(1)] == ("quick", "slow")
    assert baseline.reaching[0, place(2)] == ("quick", "slow")
    assert baseline.flaky_reaching == {(0, place(1)): ["middle", "flaky"]}
