"""Scores: each verdict has its place, and nothing valid is no score at all."""

from __future__ import annotations

import pytest

from mutabot.model import By, Outcome, Verdict
from mutabot.results.score import RoundScores, Score, groups_of
from tests.results.samples import MUTANTS, OUTCOMES

#: verdict -> (killed, valid)
PLACES = {
    Verdict.KILLED: (1, 1),
    Verdict.SURVIVED: (0, 1),
    Verdict.TIMEOUT: (1, 1),
    Verdict.NOT_COVERED: (0, 1),
    Verdict.REFUSED: (0, 0),
    Verdict.GUARDED: (0, 0),
    Verdict.INVALID: (0, 0),
    Verdict.NO_EFFECT: (0, 0),
    Verdict.UNSTABLE: (0, 0),
    Verdict.ERROR: (0, 0),
}


def outcome(verdict: Verdict, by: By | None = None, *, round: int = 0, mutant: str = "m") -> Outcome:
    return Outcome(mutant, round, verdict, by)


@pytest.mark.parametrize("verdict", Verdict)
def test_every_verdict_has_its_place_in_the_score(verdict: Verdict) -> None:
    score = Score.of([outcome(verdict)])
    assert (score.killed, score.valid) == PLACES[verdict]


def test_the_check_score_counts_only_kills_by_a_check() -> None:
    score = Score.of(
        [
            outcome(Verdict.KILLED, By.CHECK),
            outcome(Verdict.KILLED, By.EXCEPTION),
            outcome(Verdict.TIMEOUT),
            outcome(Verdict.SURVIVED),
            outcome(Verdict.REFUSED),
        ]
    )
    assert (score.score, score.check_score) == (3 / 4, 1 / 4)
    assert score.timeouts == 1


def test_nothing_valid_is_no_score_and_never_everything() -> None:
    for outcomes in ([], [outcome(Verdict.REFUSED)], [outcome(Verdict.ERROR)]):
        score = Score.of(outcomes)
        assert score.score is None
        assert score.check_score is None


def test_the_mean_is_over_rounds_and_leaves_out_rounds_without_a_score() -> None:
    scores = RoundScores.of(
        [
            outcome(Verdict.KILLED, By.CHECK, round=0),
            outcome(Verdict.SURVIVED, round=1, mutant="m"),
            outcome(Verdict.KILLED, By.EXCEPTION, round=1, mutant="n"),
            outcome(Verdict.REFUSED, round=2),
        ],
        rounds=4,
    )
    assert [score.score for score in scores.rounds] == [1.0, 0.5, None, None]
    assert scores.mean == 0.75
    assert scores.mean_check == 0.5
    assert (scores.total.killed, scores.total.valid) == (2, 3)
    assert RoundScores.of([], 3).mean is None


def test_a_kill_rate_counts_only_rounds_in_which_the_mutant_was_valid() -> None:
    ends = [outcome(Verdict.KILLED), outcome(Verdict.REFUSED), outcome(Verdict.SURVIVED)]
    assert (Score.of(ends).killed, Score.of(ends).valid) == (1, 2)
    assert Score.of(ends).score == 0.5
    assert Score.of(ends[1:2]).score is None


def test_families_and_roles_are_never_added_up() -> None:
    groups = {(group.family, group.role): group for group in groups_of(MUTANTS, OUTCOMES, 2)}
    assert set(groups) == {("robot", "program"), ("robot", "oracle")}
    program, oracle = groups["robot", "program"], groups["robot", "oracle"]
    assert (program.mutants, oracle.mutants) == (3, 2)
    assert (program.scores.total.killed, program.scores.total.valid) == (3, 5)
    assert (oracle.scores.total.killed, oracle.scores.total.valid) == (1, 3)


def test_a_group_without_outcomes_is_still_there() -> None:
    assert [group.scores.mean for group in groups_of(MUTANTS, [], 2)] == [None, None]
