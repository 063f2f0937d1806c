"""Dominators keep what they promise on any matrix of kills, and groups hold only what dies alike."""

from __future__ import annotations

from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from comparison.subsumption import Redundancy, dominators, killers_of
from mutabot.model import By, Kill, Outcome, Verdict

KILLERS = st.frozensets(st.tuples(st.sampled_from("abcd"), st.integers(0, 2)), max_size=6)
MATRICES = st.lists(KILLERS, max_size=25).map(lambda rows: dict(enumerate(rows)))


def killed(
    mutant: str, *tests: str, round: int = 0, message: str = "assert False", complete: bool = True
) -> Outcome:
    kills = tuple(Kill(test, By.CHECK, "builtins:AssertionError", message) for test in tests)
    return Outcome(
        mutant, round, Verdict.KILLED, By.CHECK, test=tests[0], message=message, tests=3, complete=complete,
        kills=kills,
    )  # fmt: skip


def subsumes(first: frozenset[tuple[str, int]], second: frozenset[tuple[str, int]]) -> bool:
    """The definition: something kills the one mutant, and whatever does kills the other too."""
    return bool(first) and first <= second


def redundancy(*outcomes: Outcome) -> Redundancy:
    mutants: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        mutants.setdefault(outcome.mutant, []).append(outcome)
    return Redundancy.of(mutants)


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
    assert killers_of([killed("m", "a"), killed("m", "a", round=1)]) == {("a", 0), ("a", 1)}
    found = redundancy(killed("m", "a"), killed("n", "a", round=1))
    assert found.dominators == (("m",), ("n",))
    assert found.alike == ()


def test_alike_are_mutants_that_die_in_the_same_tests_rounds_and_messages() -> None:
    found = redundancy(
        killed("one", "a", "b"), killed("two", "b", "a"), killed("three", "a"),
        killed("four", "a", "b", message="assert 1 == 2"),
    )  # fmt: skip
    assert found.alike == (("one", "two"),)
    assert found.redundant == 1
    assert found.dominators == (("three",),)


def test_addresses_in_messages_do_not_tell_mutants_apart() -> None:
    found = redundancy(
        killed("one", "a", message="<Arm at 0x7f00aa11>"), killed("two", "a", message="<Arm at 0x7f11bb22>")
    )
    assert found.alike == (("one", "two"),)


def test_time_outs_are_alike_only_if_the_test_is_the_same() -> None:
    def late(mutant: str, test: str) -> Outcome:
        return Outcome(mutant, 0, Verdict.TIMEOUT, test=test, message="over 10 operations", complete=True)

    assert redundancy(late("one", "a"), late("two", "a"), late("three", "b")).alike == (("one", "two"),)


def test_survivors_are_in_no_class() -> None:
    found = redundancy(killed("m", "a"), Outcome("s", 0, Verdict.SURVIVED, complete=True))
    assert (found.killed, found.unknown, found.dominators) == (1, 0, (("m",),))


def test_a_mutant_of_which_not_every_test_was_run_is_set_aside_and_counted() -> None:
    found = redundancy(killed("m", "a", complete=False), killed("n", "a", "b"))
    assert (found.killed, found.unknown, found.dominators) == (1, 1, (("n",),))
