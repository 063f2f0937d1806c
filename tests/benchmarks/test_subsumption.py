"""Groups hold only what dies alike, and no class holds what is not known."""

from __future__ import annotations

from comparison.subsumption import Redundancy
from mutabot.model import By, Kill, Outcome, Verdict


def killed(
    mutant: str, *tests: str, round: int = 0, message: str = "assert False", complete: bool = True
) -> Outcome:
    kills = tuple(Kill(test, By.CHECK, "builtins:AssertionError", message) for test in tests)
    return Outcome(
        mutant, round, Verdict.KILLED, By.CHECK, test=tests[0], message=message, tests=3, complete=complete,
        kills=kills,
    )  # fmt: skip


def redundancy(*outcomes: Outcome) -> Redundancy:
    mutants: dict[str, list[Outcome]] = {}
    for outcome in outcomes:
        mutants.setdefault(outcome.mutant, []).append(outcome)
    return Redundancy.of(mutants)


def test_the_same_test_in_another_round_is_another_killer() -> None:
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


def test_mutants_are_not_distinguished_by_addresses_in_messages() -> None:
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
