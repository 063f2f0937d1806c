"""The programs that count pulses while they move."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot_cell.fixtures import *  # noqa: F403  (new_cell)
from mutabot_languages import load
from mutabot_languages.loader import RobotProgram

ROOT = Path(__file__).parents[1]


@pytest.fixture(params=["watch.script", "watch.mod", "watch.src"])
def program(request: pytest.FixtureRequest) -> RobotProgram:
    """The program in one of the languages."""
    more = [ROOT / "moves.sys"] if request.param == "watch.mod" else []
    return load(ROOT / request.param, *more)
