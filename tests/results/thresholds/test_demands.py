"""Demands: all rounds must notice what is demanded, and not to know is a failure with its own text."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot.errors import ExitCode
from mutabot.model import Kind
from mutabot.results.gate import decide
from mutabot.thresholds.demands import Demand, parse_amount, wanted_magnitudes
from mutabot.thresholds.thresholds import unmet
from results.thresholds import journals
from results.thresholds.journals import Rungs

TEN = Demand(10.0, "mm")


@pytest.mark.parametrize(
    ("rounds", "words"),
    [
        (["SSSCCCC"] * 3, ""),
        (["SSSRRRR"] * 3, ""),
        (["SSSCCCC", "SSSRRRR"], ""),
        (["SSSCCCC", "SSSSCCC"], "survives 10 mm in round 2 (mutant 4)"),
        (["SSSCCCC", "SSSC.S."], "survives 50 mm in round 2 (mutant 6)"),
        (["-------", "-------"], "no test reaches it in rounds 1 and 2"),
        (["SSSUCCC"], "10 mm is unstable in round 1"),
        (["SSSECCC"], "10 mm ended in error in round 1"),
        (["SSS.CCC"], "10 mm was not run in round 1"),
        (["SSSNNNN"], "10 mm has no effect in any round"),
    ],
)
def test_all_rounds_must_notice_it(tmp_path: Path, rounds: list[str], words: str) -> None:
    found = list(unmet([TEN], [journals.ladder(tmp_path, *rounds)]))
    assert len(found) == bool(words)
    assert all(words in text for text in found)


def test_a_magnitude_that_is_not_on_the_ladder_is_not_taken_as_noticed(tmp_path: Path) -> None:
    (found,) = unmet([Demand(15.0, "mm")], [journals.ladder(tmp_path, "SSSCCCC")])
    assert "15 mm is not on its ladder" in found


@pytest.mark.parametrize(
    ("about", "fits"),
    [
        ({}, True),
        ({"site": "mission.py:3"}, True),
        ({"site": "mission.py:4"}, False),
        ({"site": "arm.move_by"}, True),
        ({"site": "mission.py:run:arm.move_by#1"}, True),
        ({"site": "mission.py"}, True),
        ({"quantity": "dx"}, True),
        ({"quantity": "dy"}, False),
        ({"kind": Kind.TRANSLATION}, True),
        ({"kind": Kind.ROTATION}, False),
        ({"operator": "delay"}, False),
        ({"unit": "m", "notice": 0.01}, True),
        ({"unit": "deg"}, False),
    ],
)
def test_a_demand_speaks_of_some_ladders(tmp_path: Path, about: dict[str, Any], fits: bool) -> None:
    demand = Demand(**{"notice": 10.0, "unit": "mm", **about})
    found = list(unmet([demand], [journals.ladder(tmp_path, "SSSCCCC")]))
    assert (not found) is fits
    assert all(": no ladder: " in text for text in found)


def test_the_gate_names_each_site_direction_and_round(tmp_path: Path) -> None:
    found = journals.results(tmp_path, Rungs(["SSSCCCC"] * 2), Rungs(["SSSCCCC", "SSSSCCC"], direction="-"))
    decision = decide(found, demands=[Demand(10.0, "mm", source="pyproject.toml:12")])
    assert decision.exit_code is ExitCode.SCORE_TOO_LOW
    assert decision.lines == (
        'pyproject.toml:12 · notice = "10 mm": mission.py:3 arm.move_by dx −: '
        "survives 10 mm in round 2 (mutant 11)",
    )
    assert decide(found, demands=[Demand(20.0, "mm")]).exit_code is ExitCode.FINE


@pytest.mark.parametrize(
    ("demand", "words"),
    [
        (Demand(10.0, "deg"), "fits none of 1 ladders: arm.move_by dx + in mm"),
        (Demand(10.0, "mm", kind=Kind.SPEED), "fits none of 1 ladders: arm.move_by dx + in mm"),
        (Demand(10.0, "mm", site="mision.py:3"), "unknown site 'mision.py:3'; did you mean 'mission.py:3'?"),
        (Demand(10.0, "mm", quantity="xd"), "fits none of 1 ladders: arm.move_by dx + in mm"),
        (Demand(10.0, "ms", operator="delay"), "fits none of 1 ladders: arm.move_by dx + in mm"),
    ],
)
def test_a_demand_that_fits_no_ladder_is_no_pass(tmp_path: Path, demand: Demand, words: str) -> None:
    decision = decide(journals.results(tmp_path, Rungs(["SSSCCCC"])), demands=[demand])
    assert decision.exit_code is ExitCode.SCORE_TOO_LOW
    assert words in decision.lines[0]


def test_a_campaign_without_graded_mutants_says_how_to_get_them(tmp_path: Path) -> None:
    found = journals.results(tmp_path, with_others=True, families=["robot"])
    decision = decide(found, demands=[TEN])
    assert "`mutabot run` plants those of which a demand speaks" in decision.lines[0]


@pytest.mark.parametrize(
    ("text", "amount"),
    [
        ("5 mm", (5.0, "mm")), ("5mm", (5.0, "mm")), ("0.5 m/s^2", (0.5, "m/s^2")), ("5 %", (5.0, "percent")),
        ("1e-3 m", (0.001, "m")), ("3", (3.0, None)),
    ],
)  # fmt: skip
def test_amounts_are_a_number_and_a_unit(text: str, amount: tuple[float, str | None]) -> None:
    assert parse_amount(text) == amount


@pytest.mark.parametrize("text", ["", "mm", "five mm", "-5 mm", "0 mm", "1e999 mm"])
def test_other_texts_are_no_amounts(text: str) -> None:
    with pytest.raises(ValueError, match="magnitude"):
        parse_amount(text)


def test_the_ladder_gets_what_is_demanded_in_its_own_unit() -> None:
    mutant = Rungs((), unit="m").mutant(1, 1.0)
    demands = [
        Demand(5.0, "mm"),
        Demand(15.0, "mm", site="mission.py:3"),
        Demand(1.0, "deg"),
        Demand(0.005, "m"),
    ]
    assert wanted_magnitudes(demands, mutant, Kind.TRANSLATION) == (0.005, 0.015)
    assert wanted_magnitudes([Demand(7.0, "mm", site="other.py")], mutant, None) == ()
