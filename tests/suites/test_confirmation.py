"""Suites in which most tests do not reach a mutant: what is found without them is what plain pytest finds."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.engines import confirmation
from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from mutabot.model import Outcome
from tests.campaign.project import Quiet, request_for, write_project

from .agreement import compare

MISSION = """
    def wave(arm):
        arm.move_by(0.1)
        arm.move_by(0.2)
        arm.move_by(-0.1)

    def store(arm):
        arm.move_by(0.3)

    def pick(arm):
        arm.move_by(0.4)

    def late(arm):
        arm.move_by(0.05)
"""
#: a test that needs what another has done in between; one that sees what another has left behind
TESTS = """
    import builtins
    import time

    import mission
    import pytest
    from robot import Arm

    builtins.CELL = {{"clean": True, "x": 0.3}}  # where nobody looks for state

    @pytest.fixture(scope="module")
    def arm():
        return Arm()

    def test_it_waves(arm):
        mission.wave(arm)

    def test_it_stores():
        arm = Arm()
        mission.store(arm)
        CELL["x"] = arm.x

    def test_it_picks():
        assert CELL["clean"]
        mission.pick(Arm())
        CELL["clean"] = False

    def test_it_cleans():
        CELL["clean"] = True

    def test_it_picks_again():
        assert CELL["clean"]
        mission.pick(Arm())

    def test_nobody_checks():
        mission.late(Arm())

    @pytest.mark.parametrize("number", range({many}))
    def test_other_things(number):
        time.sleep(0.01)
        {notices}

    def test_somebody_checks():
        arm = Arm()
        mission.late(arm)
        assert arm.x == 0.05
"""
NOTICES = 'assert abs(CELL["x"] - 0.3) < 0.01'


def project(folder: Path, notices: str = "pass", many: int = 60) -> Path:
    judged = '[judge]\nrefusals = ["robot.Refused"]\n'
    return write_project(
        folder, MISSION, TESTS.format(notices=notices, many=many), more={"judge.toml": judged}
    )


@pytest.fixture
def always(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also small suites leave tests out."""
    monkeypatch.setattr(confirmation, "LEAST", 0.0)


def campaign(folder: Path, **changes: object) -> tuple[list[Outcome], list[str]]:
    quiet = Quiet()
    with Journal.open(run_campaign(request_for(folder, **changes), quiet)) as journal:
        return journal.outcomes(), quiet.lines


@pytest.mark.usefixtures("always")
@pytest.mark.parametrize("notices", ["pass", NOTICES])
def test_verdicts_are_those_of_plain_pytest(tmp_path: Path, notices: str) -> None:
    found = compare(project(tmp_path / "many", notices), engines=("branch",))
    assert found.disagreements == []
    assert len(found.compared) > 20
