"""Dominators keep what they promise on any matrix of kills."""

from __future__ import annotations

from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from mutabot.model import By, Kill, Outcome, Verdict
from mutabot.results.results import MutantResult
from mutabot_minimal.subsumption import dominators, killers_of
from tests.results import samples

KILLERS = st.frozensets(st.tuples(st.sampled_from("abcd"), st.integers(0, 2)), max_size=6)
MATRICES = st.lists(KILLERS, max_size=25).map(lambda rows: dict(enumerate(rows)))


def subsumes(first: frozenset[tuple[str, int]], second: frozenset[tuple[str, int]]) -> bool:
    """The definition: something kills the one mutant, and whatever does kills the other too."""
    return bool(first) and first <= second


@given(MATRICES)
def test_no_dominator_subsumes_another_and_members_of_one_subsume_each_other(
    matrix: dict[int, frozenset[tuple[str, int]]],
) -> None:
    found = dominators(matrix)
    for first, second in combinations(found, 2):
        assert not subsumes(matrix[first[0]], matrix[second[0]])
        assert not subsumes(matrix[second[0]], matrix[first[0]])
    for members in found:
        assert len({matrix[member] for member in members}) == 1


@given(MATRICES)
def test_every_killed_mutant_is_subsumed_by_a_dominator(
    matrix: dict[int, frozenset[tuple[str, int]]],
) -> None:
    found = dominators(matrix)
    for mutant, killers in matrix.items():
        subsumed = [members for members in found if subsumes(matrix[members[0]], killers)]
        assert bool(subsumed) == bool(killers), mutant


@given(MATRICES, KILLERS)
def test_tests_that_kill_all_dominators_kill_all_that_can_be_killed(
    matrix: dict[int, frozenset[tuple[str, int]]], suite: frozenset[tuple[str, int]]
) -> None:
    if all(matrix[members[0]] & suite for members in dominators(matrix)):
        assert all(killers & suite for killers in matrix.values() if killers)


@given(MATRICES)
def test_no_dominator_can_be_spared(matrix: dict[int, frozenset[tuple[str, int]]]) -> None:
    """For each there is a suite that kills all others and lets it live: everything but what kills it."""
    found = dominators(matrix)
    everything = frozenset().union(*matrix.values())
    for spared in found:
        suite = everything - matrix[spared[0]]
        assert all(matrix[other[0]] & suite for other in found if other != spared)


@given(MATRICES, st.randoms())
def test_the_order_of_mutants_does_not_matter(
    matrix: dict[int, frozenset[tuple[str, int]]], random: object
) -> None:
    names = list(matrix)
    random.shuffle(names)  # type: ignore[attr-defined]
    shuffled = dominators({name: matrix[name] for name in names})
    assert {frozenset(group) for group in shuffled} == {frozenset(group) for group in dominators(matrix)}


def test_the_same_test_in_another_round_is_another_killer() -> None:
    kill = (Kill("a", By.CHECK),)
    ends = tuple(Outcome("m", round, Verdict.KILLED, test="a", kills=kill) for round in (0, 1))
    assert killers_of(MutantResult(samples.MUTANTS[0], ends, None, "")) == {("a", 0), ("a", 1)}


def test_a_time_out_is_noticed_by_its_test_and_a_survivor_by_none() -> None:
    assert Outcome("m", 0, Verdict.TIMEOUT, test="a").noticing_tests == {"a"}
    assert Outcome("m", 0, Verdict.SURVIVED).noticing_tests == frozenset()
