"""Each verdict's place in the score."""

from __future__ import annotations

import pytest

from mutabot.model import Verdict

#: verdict -> (stands in the denominator, stands in the numerator)
PLACES = {
    "killed": (True, True),
    "survived": (True, False),
    "timeout": (True, True),
    "refused": (False, False),
    "guarded": (False, False),
    "invalid": (False, False),
    "no effect": (False, False),
    "not covered": (True, False),
    "unstable": (False, False),
    "error": (False, False),
}


@pytest.mark.parametrize("verdict", Verdict)
def test_a_verdict_has_its_place_in_the_score(verdict: Verdict) -> None:
    assert (verdict.is_valid, verdict.is_killed) == PLACES[verdict]


def test_there_is_no_verdict_but_these() -> None:
    assert {verdict.value for verdict in Verdict} == PLACES.keys()
