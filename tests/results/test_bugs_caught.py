"""Beside a score stands what suites with such a score caught of real bugs, where that is known."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

import mutabot
from mutabot.journal.records import Since
from mutabot.model import Outcome, Verdict
from mutabot.results.bugs_caught import BANDS, MUTANTS, band_of, bugs_caught
from mutabot.results.score import Group, RoundScores
from tests.report.material import stored


def group(family: str, role: str, killed: int, survived: int) -> Group:
    """Scores of one round."""
    verdicts = [Verdict.KILLED] * killed + [Verdict.SURVIVED] * survived
    outcomes = [Outcome(f"m{number}", 0, verdict) for number, verdict in enumerate(verdicts)]
    return Group(family, role, len(outcomes), RoundScores.of(outcomes, 1))


@pytest.mark.parametrize(
    ("killed", "band"),
    [(0, "0 to 20"), (19, "0 to 20"), (20, "20 to 40"), (79, "60 to 80"), (100, "80 to 100")],
)
def test_the_sentence_is_that_of_the_band_of_the_score(killed: int, band: str) -> None:
    text = group("robot", "program", killed, 100 - killed).bugs_caught
    assert text is not None
    assert f"robot scores of {band} %" in text
    caught = BANDS["robot"][band_of(killed / 100)]
    assert f"caught {caught.low} to {caught.high} % of the real bugs; the mean is {caught.mean} %" in text


def test_nothing_is_said_of_what_the_benchmark_does_not_have() -> None:
    assert group("robot", "program", MUTANTS - 1, 0).bugs_caught is None
    assert group("robot", "program", MUTANTS, 0).bugs_caught is not None
    assert group("robot", "oracle", MUTANTS, 0).bugs_caught is None
    assert group("patch", "program", MUTANTS, 0).bugs_caught is None
    assert bugs_caught("robot", None, 0) is None


def test_shares_grow_with_the_score_and_hold_their_mean() -> None:
    for bands in BANDS.values():
        assert [caught.mean for caught in bands] == sorted(caught.mean for caught in bands)
        assert all(0 <= caught.low <= caught.mean <= caught.high <= 100 for caught in bands)


def test_only_a_whole_campaign_says_something_of_bugs(tmp_path: Path) -> None:
    results: mutabot.StoredCampaign = stored(tmp_path)
    assert not results.bugs_caught  # too few mutants
    groups = (group("robot", "program", 20, 0),)
    whole = dataclasses.replace(results, groups=groups, state="complete", since=None)
    assert len(whole.bugs_caught) == 1
    assert not dataclasses.replace(whole, state="interrupted").bugs_caught
    assert not dataclasses.replace(whole, since=Since("main", "0" * 40)).bugs_caught
