"""Ladders, whatever became of their magnitudes."""

from __future__ import annotations

import io
import math
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mutabot.report.document import data_of, dumps
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.thresholds import print_thresholds
from mutabot.thresholds.ladders import Ladder, ladders_of
from mutabot.thresholds.thresholds import ladder_line, thresholds_of
from results.thresholds import journals
from results.thresholds.journals import LETTERS, SIZES, Rungs

ROUND = st.text("".join(LETTERS) + ".CCCSSS", min_size=len(SIZES), max_size=len(SIZES))


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rounds=st.lists(ROUND, min_size=1, max_size=6))
def test_whatever_was_seen_can_be_described(
    tmp_path_factory: pytest.TempPathFactory, rounds: list[str]
) -> None:
    both = Rungs(rounds), Rungs(rounds, direction="-")
    results = journals.results(tmp_path_factory.mktemp("ladder"), *both)
    found = thresholds_of(results)
    assert len(found.all) == 2
    for ladder in found.ladders:
        assert_sound(ladder)
    print_thresholds(make_console(io.StringIO(), width=80), found)
    dumps(data_of(found))


def assert_sound(ladder: Ladder) -> None:
    assert ladder_line(ladder)
    assert all(low < high for low, high in zip(ladder.lows, ladder.highs, strict=True))
    assert ladder.none_up_to < ladder.half_from <= ladder.all_from
    for ladder_round in ladder.counted:
        high = ladder_round.bracket.high
        assert high is None or ladder_round.noticed_by is not None


def test_a_refusal_is_no_detection(tmp_path: Path) -> None:
    """The published program: at 50 mm five of five tests fail, all since the robot refuses."""
    found = journals.ladder(tmp_path, "SSSSCRR", *["SSSSSRR"] * 4)
    assert math.isinf(found.all_from)
    assert found.refused_from == 50.0


def test_a_ladder_that_was_not_run_is_there(tmp_path: Path) -> None:
    (found,) = ladders_of(journals.results(tmp_path, Rungs(["......."] * 2), rounds=2))
    assert found.why_unjudged == "was not run"
