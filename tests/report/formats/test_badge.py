"""The badge: never one score for several roles, never 100 % for less, and grey where nothing is known."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from analysis import samples
from mutabot.model import By, Outcome, Verdict
from report.material import made, stored


def badge(folder: Path, **changes: Any) -> Any:
    return json.loads(made("badge", stored(folder, **changes)))


def test_each_role_has_its_score_and_the_lowest_gives_the_colour(tmp_path: Path) -> None:
    found = badge(tmp_path)
    assert found == {
        "schemaVersion": 1,
        "label": "mutation score",
        "message": "program 58 %, oracle 25 %",
        "color": "red",
    }


@pytest.mark.parametrize(
    ("killed", "message", "colour"),
    [(200, "100", "brightgreen"), (199, "99", "brightgreen"), (160, "80", "green"),
     (159, "79", "yellowgreen"), (100, "50", "orange"), (0, "0", "red")],
)  # fmt: skip
def test_a_score_is_rounded_down(tmp_path: Path, killed: int, message: str, colour: str) -> None:
    mutants = tuple(
        samples.mutant(number, f"made-{number}", samples.MOVE, "dx", "") for number in range(1, 201)
    )
    ends = tuple(
        Outcome(one.id, 0, Verdict.KILLED, By.CHECK)
        if index < killed
        else Outcome(one.id, 0, Verdict.SURVIVED)
        for index, one in enumerate(mutants)
    )
    found = badge(tmp_path, mutants=mutants, outcomes=ends, rounds=1)
    assert (found["message"], found["color"]) == (f"program {message} %", colour)


def test_nothing_is_known_of_a_campaign_that_is_not_complete(tmp_path: Path) -> None:
    found = badge(tmp_path / "a", outcomes=samples.OUTCOMES[:2], finish="interrupted")
    assert (found["message"], found["color"]) == ("program 100 % (not complete)", "lightgrey")
    found = badge(tmp_path / "b", outcomes=())
    assert (found["message"], found["color"]) == ("unknown", "lightgrey")
