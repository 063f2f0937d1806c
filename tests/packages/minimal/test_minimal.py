"""The minimal set leaves out what another mutant stands for, and nothing else; no mutant counts twice."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from mutabot.model import By, Kill, Mutant, Outcome, Role, Verdict
from mutabot.results.results import MutantResult, Results
from mutabot.results.score import RoundScores
from mutabot_minimal.minimal import minimal_of, section
from tests.plugins.test_plugins import mutabot, project
from tests.results import samples

__all__ = ["project"]

FAMILIES = ("robot", "bugs", "conventional")
#: of each mutant: its family, its line, its fault, and the tests that kill it
PLANTED = st.tuples(
    st.sampled_from(FAMILIES),
    st.integers(1, 2),
    st.sampled_from("xy"),
    st.frozensets(st.sampled_from("abcd")),
)
APPROACH = """import robot

def run():
    for _ in range(5):
        if robot.distance() > 0.101:
            robot.forward(0.01)
"""
Planted = tuple[str, int, str, frozenset[str]]


def campaign(planted: Sequence[Planted], *, complete: bool = True, every_test: bool = True) -> Results:
    """A campaign of one round with these mutants."""
    found = []
    for number, (family, line, fault, tests) in enumerate(planted, start=1):
        at = samples.site("mission.py", line, "arm.move_by", Role.PROGRAM, occurrence=line)
        mutant = Mutant(number, family, "skip", at, "", None, None, str(number), fault)
        kills = tuple(Kill(test, By.CHECK) for test in sorted(tests))
        verdict = Verdict.KILLED if kills else Verdict.SURVIVED
        outcome = Outcome(mutant.id, 0, verdict, By.CHECK, complete=complete, kills=kills)
        found.append(MutantResult(mutant, (outcome,), None, ""))
    meta = {"every_test": every_test, "seconds": 12.0}
    return Results(meta, "complete", 1, tuple(found), (), RoundScores.of([], 1), (), (), ())


@given(st.lists(PLANTED, max_size=15))
def test_each_mutant_is_in_the_set_or_one_of_the_set_stands_for_it(planted: list[Planted]) -> None:
    found = minimal_of(campaign(planted))
    assert found is not None
    kept = [planted[one.number - 1] for one in (*found.dominators, *found.survivors)]
    for _, line, fault, tests in planted:
        if tests:
            assert any(other[3] and other[3] <= tests for other in kept)
        else:
            assert [other[1:3] for other in kept if not other[3]].count((line, fault)) == 1
    assert found.size == len(kept) <= len(planted)


@given(st.lists(PLANTED, max_size=10))
def test_what_two_families_make_counts_once(planted: list[Planted]) -> None:
    others = {"robot": "bugs", "bugs": "conventional", "conventional": "robot"}
    doubled = [*planted, *((others[family], line, fault, tests) for family, line, fault, tests in planted)]
    once, twice = minimal_of(campaign(planted)), minimal_of(campaign(doubled))
    assert once is not None
    assert twice is not None
    assert once.size == twice.size
    assert all(share.alone == 0 for share in twice.families)


@given(st.lists(PLANTED, max_size=15))
def test_shares_of_families_add_up(planted: list[Planted]) -> None:
    found = minimal_of(campaign(planted))
    assert found is not None
    assert sum(share.mutants for share in found.families) == found.mutants == len(planted)
    assert sum(share.killed for share in found.families) == found.killed
    assert sum(share.alone for share in found.families) <= len(found.dominators)
    assert sum(share.joint for share in found.families) >= len(found.dominators)
    assert all(share.alone <= share.joint <= share.minimal for share in found.families)


def test_a_mutant_stands_for_those_that_it_subsumes() -> None:
    found = minimal_of(
        campaign([
            ("robot", 1, "x", frozenset("a")), ("bugs", 1, "y", frozenset("ab")),
            ("bugs", 2, "x", frozenset("a")), ("bugs", 2, "y", frozenset("b")),
        ])
    )  # fmt: skip
    assert found is not None
    assert [(one.number, one.killed_by, one.stands_for) for one in found.dominators] == [(1, 1, 2), (4, 1, 1)]
    assert [(share.family, share.minimal, share.joint, share.alone) for share in found.families] == [
        ("robot", 1, 1, 0), ("bugs", 2, 2, 1),
    ]  # fmt: skip


def test_killed_mutants_of_which_not_every_test_was_run_are_set_aside_and_counted() -> None:
    found = minimal_of(campaign([("robot", 1, "x", frozenset("a"))], complete=False))
    assert found is not None
    assert (found.killed, found.unknown, found.dominators) == (1, 1, ())


def test_a_campaign_that_stopped_at_the_first_test_has_no_minimal_set() -> None:
    results = campaign([("robot", 1, "x", frozenset("a"))], every_test=False)
    assert minimal_of(results) is None
    assert section(results) is None


def test_a_campaign_of_two_families_has_one_set(project: Path) -> None:
    # without the loop, which mutants make endless: each of those computes until its time is up
    (project / "approach.py").write_text(APPROACH, encoding="utf-8")
    done = mutabot(None, project, "minimal", "--family", "robot,conventional", "--json")
    assert done.returncode == 0, done.stderr
    found: Mapping[str, object] = json.loads(done.stdout)
    assert found["mutants"] == sum(share["mutants"] for share in found["families"])  # type: ignore[attr-defined]
    assert {share["family"] for share in found["families"]} == {"robot", "conventional"}  # type: ignore[attr-defined]
    results = json.loads(mutabot(None, project, "results", "--json").stdout)
    assert results["sections"]["minimal"] == found
    shown = mutabot(None, project, "minimal", "--family", "robot,conventional")
    assert f"Minimal set: {found['size']} of {found['mutants']} mutants" in shown.stdout
