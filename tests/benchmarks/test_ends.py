"""Ends and properties: each verdict ends up in one place, and nothing unknown is claimed."""

from __future__ import annotations

import pytest

from comparison.ends import End, end_of, properties_of
from mutabot.model import By, Kill, Outcome, Verdict

A, B = "tests/test_a.py::test_a", "tests/test_a.py::test_b"


def killed(
    *tests: str, of: int | None = None, round: int = 0, by: By = By.CHECK, complete: bool = True
) -> Outcome:
    """Killed by these tests of so many that reach it."""
    kills = tuple(Kill(test, by, message="assert False") for test in tests)
    return Outcome(
        "m", round, Verdict.KILLED, by, test=tests[0], tests=of or len(tests), complete=complete, kills=kills
    )  # fmt: skip


def ended(verdict: Verdict, *, same: bool | None = None, round: int = 0) -> Outcome:
    return Outcome("m", round, verdict, tests=1, indistinguishable=same, complete=True)


@pytest.mark.parametrize("verdict", Verdict)
def test_every_verdict_has_an_end(verdict: Verdict) -> None:
    assert end_of(Outcome("m", 0, verdict)) in End


def test_every_end_comes_from_some_outcome() -> None:
    outcomes = [Outcome("m", 0, verdict) for verdict in Verdict]
    outcomes += [killed(A), ended(Verdict.SURVIVED, same=True)]
    outcomes += [Outcome("m", 0, Verdict.KILLED, By.EXCEPTION, commands=0)]
    assert {end_of(outcome) for outcome in outcomes} == set(End)


@pytest.mark.parametrize(
    ("by", "commands", "end"),
    [
        (By.CHECK, 0, End.CHECK),
        (By.CHECK, None, End.CHECK),
        (By.EXCEPTION, 0, End.BEFORE),
        (By.EXCEPTION, 1, End.EXCEPTION),
        (By.EXCEPTION, None, End.EXCEPTION),
    ],
)
def test_before_any_command_is_said_of_exceptions_alone_and_only_where_it_is_known(
    by: By, commands: int | None, end: End
) -> None:
    assert end_of(Outcome("m", 0, Verdict.KILLED, by, commands=commands)) is end


def test_a_survivor_whose_world_was_not_compared_is_not_called_indistinguishable() -> None:
    assert end_of(ended(Verdict.SURVIVED, same=None)) is End.SURVIVED
    assert end_of(ended(Verdict.SURVIVED, same=True)) is End.INDISTINGUISHABLE


def test_trivial_is_a_mutant_that_every_test_notices_in_every_round() -> None:
    assert properties_of([killed(A, B), killed(A, B, round=1)]).trivial is True
    assert properties_of([killed(A, B), killed(A, of=2, round=1)]).trivial is False
    assert properties_of([killed(A, B), ended(Verdict.SURVIVED, round=1)]).trivial is False
    assert properties_of([killed(A, B), ended(Verdict.TIMEOUT, round=1)]).trivial is False


def test_a_time_out_is_noticed_by_its_test() -> None:
    late = Outcome("m", 0, Verdict.TIMEOUT, test=A, tests=1, complete=True)
    assert properties_of([late]).trivial is True


def test_trivial_is_not_known_where_not_every_test_was_run() -> None:
    assert properties_of([killed(A, complete=False)]).trivial is None
    assert properties_of([killed(A), None]).trivial is None
    assert properties_of([killed(A, complete=False), ended(Verdict.SURVIVED)]).trivial is False


@pytest.mark.parametrize("silent", sorted(set(Verdict) - {Verdict.KILLED, Verdict.SURVIVED, Verdict.TIMEOUT}))
def test_rounds_in_which_no_test_could_judge_it_say_nothing(silent: Verdict) -> None:
    assert properties_of([killed(A), ended(silent, round=1)]).trivial is True
    found = properties_of([ended(Verdict.SURVIVED, same=True), ended(silent, round=1)])
    assert found.indistinguishable
    assert found.informative is False
    alone = properties_of([ended(silent)])
    assert (alone.trivial, alone.indistinguishable, alone.reached) == (False, False, False)


def test_indistinguishable_needs_every_judged_round() -> None:
    same, other = ended(Verdict.SURVIVED, same=True), ended(Verdict.SURVIVED, same=False, round=1)
    assert properties_of([same, same]).indistinguishable
    assert not properties_of([same, other]).indistinguishable
    assert not properties_of([same, killed(A, round=1)]).indistinguishable


@pytest.mark.parametrize(
    ("rounds", "informative"),
    [
        ([killed(A, of=2)], True),
        ([killed(A, B)], False),
        ([killed(A, complete=False)], None),
        ([ended(Verdict.SURVIVED, same=False)], True),
        ([ended(Verdict.SURVIVED, same=True)], False),
        ([ended(Verdict.NOT_COVERED)], True),
        ([ended(Verdict.REFUSED)], False),
        ([ended(Verdict.REFUSED), killed(A, of=2)], True),
        ([None], False),
        ([], False),
    ],
)
def test_informative_is_valid_not_trivial_and_not_indistinguishable(
    rounds: list[Outcome | None], informative: bool | None
) -> None:
    assert properties_of(rounds).informative is informative
