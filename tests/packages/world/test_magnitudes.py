"""Magnitudes of disturbances that users demand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from mutabot.api.faults import Original, Project
from mutabot_world.provider import WorldFaults
from mutabot_world.tables import WorldTable

TEST = "tests/test_belt.py::test_it"


def test_a_demanded_magnitude_changes_the_disturbance_and_what_is_said_of_it() -> None:
    row = {
        "name": "speed", "of": ["belt:Belt"], "path": "speed", "change": "scale", "ladder": [1.0, 50.0],
        "more": "from 1 s on a belt that is {} faster",
    }  # fmt: skip
    ends: Any = {(0, TEST): SimpleNamespace(simulated=None)}
    tables = {"world": WorldTable.model_validate({"parameter": [row]})}
    provider = WorldFaults()
    planned = provider.plan(Project(tables=tables), Original(tests=[[TEST]], ends=ends)).mutants
    first = next(
        result for result in planned if result.mutant.magnitude == 1.0 and result.mutant.direction == "+"
    )
    made = provider.at_magnitude(first, 20.0)
    assert made.mutant.description == "from 1 s on a belt that is 20 % faster"
    assert (made.mutant.variant, made.mutant.magnitude) == ("+20%", 20.0)
    assert made.active is not None
    assert made.active.data == made.does
    assert made.does["amount"] == 0.2
