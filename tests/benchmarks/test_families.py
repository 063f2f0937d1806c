"""Families side by side: every outcome is counted once, and nothing is claimed that is not known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from comparison.ends import End, end_of
from comparison.families import WEAKNESSES, FamilyComparison, Share, compare_families
from mutabot.results.results import Results
from mutabot.results.statistics import crossed, wilson
from results import samples

from . import campaigns


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return campaigns.read(campaigns.write(tmp_path_factory.mktemp("made") / "compare.sqlite"))


@pytest.fixture(scope="module")
def comparison(results: Results) -> FamilyComparison:
    return compare_families(results)


def test_there_is_a_column_for_each_family_and_role_in_the_order_asked_for(
    comparison: FamilyComparison,
) -> None:
    assert [(family.name, family.role) for family in comparison.families] == [
        ("robot", "program"), ("robot", "oracle"), ("conventional", "program"), ("text", "program"),
    ]  # fmt: skip


def test_the_program_stands_before_the_oracle_whichever_the_plan_has_first(results: Results) -> None:
    turned = compare_families(replace(results, mutants=results.mutants[::-1]))
    assert [family.role for family in turned.families if family.name == "robot"] == ["program", "oracle"]


def test_every_outcome_has_one_end_and_every_end_is_there(comparison: FamilyComparison) -> None:
    for family in comparison.families:
        assert set(family.ends) == set(End)
        assert sum(share.count for share in family.ends.values()) == family.done == family.planned
        assert all(share.of == family.done for share in family.ends.values())


def test_shares_of_ends_are_those_of_the_outcomes(results: Results, comparison: FamilyComparison) -> None:
    robot = comparison.families[0]
    ends = [end_of(outcome) for result in results.mutants[:30] for outcome in result.outcomes]
    assert {end: share.count for end, share in robot.ends.items()} == {end: ends.count(end) for end in End}


def test_a_weakness_is_the_sum_of_its_ends(comparison: FamilyComparison) -> None:
    for family in comparison.families:
        for name, ends in WEAKNESSES.items():
            assert family.weaknesses[name].count == sum(family.ends[end].count for end in ends)


def test_no_end_speaks_of_two_weaknesses_and_any_is_all_of_them() -> None:
    single = [ends for name, ends in WEAKNESSES.items() if name != "any"]
    assert frozenset().union(*single) == WEAKNESSES["any"]
    assert sum(map(len, single)) == len(WEAKNESSES["any"])


def test_scores_agree_with_the_groups_of_the_report(results: Results, comparison: FamilyComparison) -> None:
    groups = {(group.family, group.role): group.scores for group in results.groups}
    for family in comparison.families:
        assert family.scores == groups[family.name, family.role]


def test_scores_agree_with_the_ends(comparison: FamilyComparison) -> None:
    killed = (End.CHECK, End.EXCEPTION, End.BEFORE, End.TIMEOUT)
    for family in comparison.families:
        assert family.scores.total.killed == sum(family.ends[end].count for end in killed)
        assert family.scores.total.by_check == family.ends[End.CHECK].count


def test_informative_is_what_is_left_of_the_valid(comparison: FamilyComparison) -> None:
    for family in comparison.families:
        left = family.valid.count - family.trivial.count - family.indistinguishable.count
        assert family.informative.count == left
        assert family.informative.of == family.mutants


def test_costs_add_up(comparison: FamilyComparison) -> None:
    for family in comparison.families:
        assert family.cost.wall == pytest.approx(0.5 * family.done)
        assert family.cost.cpu == pytest.approx(0.4 * family.done)
        assert family.cost.simulated == pytest.approx(8.0 * family.done)
        assert family.cost.shared == pytest.approx(5.0 * family.done)


def test_places_are_sites_each_counted_once(comparison: FamilyComparison) -> None:
    assert [family.places for family in comparison.families] == [10, 4, 40, 20]


def test_joint_dominators_are_shared_out_among_the_families(comparison: FamilyComparison) -> None:
    classes = comparison.redundancy.dominators
    assert len(classes) > 0
    for family in comparison.families:
        assert family.alone <= family.joint <= len(classes)
    assert sum(family.joint for family in comparison.families) >= len(classes)


def test_a_family_without_a_mutant_is_there_with_nothing(results: Results) -> None:
    only_robot = tuple(result for result in results.mutants if result.mutant.family == "robot")
    groups = tuple(group for group in results.groups if group.family == "robot")
    found = compare_families(replace(results, mutants=only_robot, groups=groups))
    text = found.families[-1]
    assert (text.name, text.role, text.mutants, text.planned) == ("text", "program", 0, 0)
    assert text.scores.mean is None
    assert text.informative == Share(0, 0)


def test_where_not_every_test_was_run_nothing_is_said_about_trivial_mutants(tmp_path: Path) -> None:
    found = compare_families(campaigns.read(campaigns.write(tmp_path / "c.sqlite", complete=False)))
    for family in found.families:
        assert family.trivial.count == 0
        assert family.trivial.unknown > 0
        assert family.trivial.share is family.trivial.interval is family.informative.share is None
        assert family.redundancy.dominators == ()
        assert family.redundancy.unknown > 0


def test_shares_carry_the_interval_of_scores_and_with_one_round_wilsons(tmp_path: Path) -> None:
    share = (
        compare_families(campaigns.read(campaigns.write(tmp_path / "a.sqlite"))).families[2].ends[End.CHECK]
    )
    assert share.interval is not None
    assert share.share is not None
    assert share.interval.low < share.share < share.interval.high
    once = compare_families(campaigns.read(campaigns.write(tmp_path / "b.sqlite", rounds=1))).families[2]
    assert once.ends[End.CHECK].interval == wilson(once.ends[End.CHECK].count, 120)
    assert crossed([[1.0], [0.0]]) is None


def test_the_scores_without_an_oracle_stand_beside_the_others(tmp_path: Path, results: Results) -> None:
    other = campaigns.read(campaigns.write(tmp_path / "other.sqlite", luck=2))
    found = compare_families(results, other)
    for family, group in zip(found.families, other.groups, strict=True):
        assert family.without_oracle == group.scores
    assert all(family.without_oracle is None for family in compare_families(results).families)


def test_a_campaign_of_one_family_is_compared_with_nobody(tmp_path: Path) -> None:
    found = compare_families(campaigns.read(samples.write_journal(tmp_path / "journal.sqlite")))
    assert [(family.name, family.role, family.mutants) for family in found.families] == [
        ("robot", "program", 3), ("robot", "oracle", 2),
    ]  # fmt: skip
