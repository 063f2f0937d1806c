"""One state per mutant, and the rounds in words."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from mutabot.model import By, Compared, Diverged, Outcome, Verdict
from mutabot.report.texts import next_step, rounds_text
from mutabot.results.results import MutantResult
from results import samples

K, T, S, N = Verdict.KILLED, Verdict.TIMEOUT, Verdict.SURVIVED, Verdict.NOT_COVERED
R, I, O, U, E = Verdict.REFUSED, Verdict.INVALID, Verdict.NO_EFFECT, Verdict.UNSTABLE, Verdict.ERROR  # noqa: E741


def result(*verdicts: Verdict | None) -> MutantResult:
    rounds = tuple(
        Outcome("m", round, verdict, By.CHECK if verdict is K else None) if verdict is not None else None
        for round, verdict in enumerate(verdicts)
    )
    return MutantResult(samples.SKIP, rounds, None, "")


@pytest.mark.parametrize(
    ("verdicts", "status"),
    [
        ((K, K, K), K),
        ((T, T), T),
        ((K, T), K),
        ((K, S, K), S),
        ((S, N), S),
        ((K, N), N),  # it is killed wherever a test reaches it
        ((N, N), N),
        ((N, R), N),
        ((K, R, E), K),
        ((K, None), K),
        ((E, S), S),
        ((O, R, U, E), E),
        ((I, R), R),
        ((O, I), I),
        ((O, None), O),
        ((U, O), U),
        ((None, None), None),
        ((), None),
    ],
)
def test_the_state_is_what_there_is_to_act_on(
    verdicts: tuple[Verdict | None, ...], status: Verdict | None
) -> None:
    assert result(*verdicts).status is status


def test_rounds_are_grouped_by_their_end() -> None:
    assert rounds_text(result(K, K, S, None, None, None)) == (
        "killed by check in rounds 1 and 2, survived in round 3, not run in rounds 4 to 6"
    )
    assert rounds_text(result(S, K, S, S, S)) == "survived in rounds 1 and 3 to 5, killed by check in round 2"
    assert rounds_text(result()) == "not run"


@pytest.mark.parametrize(
    ("survivor", "step", "names_probe"),
    [
        ({"distance": 312.0}, "Run `mutabot suggest", False),
        ({"indistinguishable": True, "distance": 0.0}, "Add a probe or a test", False),
        ({"diverged": (Diverged("test", 1.0, "box", "the box fell"),)}, "Run `mutabot suggest", False),
        # no probe, or none that could be read: checks of what the tests hold are found even so
        ({}, "Run `mutabot suggest", True),
        ({"divergence": ("call 2: wrote 1 instead of 2",)}, "Run `mutabot suggest", True),
        ({"gaps": ("no probe reads anything",)}, "Run `mutabot suggest", True),
    ],
)
def test_the_next_step_names_a_probe_where_nothing_read_how_the_world_ended(
    survivor: dict[str, Any], step: str, names_probe: bool
) -> None:
    found = next_step(MutantResult(samples.SKIP, (Outcome("m", 0, S, **survivor),), None, ""))
    assert found.startswith(step)
    assert ("[[probe]]" in found) is names_probe


def test_a_project_without_calls_of_a_robot_needs_no_probe() -> None:
    def step(calls: int) -> str:
        survived = Outcome("m", 0, S, compared=Compared(calls=calls, returned=3))
        return next_step(MutantResult(replace(samples.SKIP, operation=""), (survived,), None, ""))

    assert "[[probe]]" not in step(0)
    assert "[[probe]]" in step(2)
