"""Suites in which most tests do not reach a mutant: what is found without them is what plain pytest finds."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign import confirmation
from mutabot.campaign.run import run_campaign
from mutabot.journal.journal import Journal
from mutabot.model import Outcome, Verdict
from tests.campaign.project import REPLAY, Quiet, request_for, write_project

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

    builtins.CELL = {{"clean": True, "x": 0.3, "rigs": 0, "shelves": 0}}  # where nobody looks for state

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
#: fixtures of modules and classes that end with tests which are left out, and tests that look at that
RIGS = """
    import mission
    import pytest
    from robot import Arm

    @pytest.fixture(scope="module")
    def rig():
        CELL["rigs"] += 1
        yield
        CELL["rigs"] -= 1

    class TestShelf:
        @pytest.fixture(scope="class", autouse=True)
        def shelf(self):
            CELL["shelves"] += 1
            yield
            CELL["shelves"] -= 1

        def test_one(self, rig):
            pass

        def test_two(self, rig):
            mission.wave(Arm())

        def test_three(self, rig):
            assert CELL["shelves"] == 1

    def test_after_the_class(rig):
        assert CELL["shelves"] == 0
        mission.wave(Arm())

    def test_last(rig):
        pass
"""
LAST = """
    import mission
    from robot import Arm

    def test_first():
        assert CELL["rigs"] == 0

    def test_no_rig_is_left():
        assert CELL["rigs"] == 0
        mission.wave(Arm())
"""
NOTICES = 'assert abs(CELL["x"] - 0.3) < 0.01'


def project(folder: Path, notices: str = "pass", many: int = 30) -> Path:
    more = {"tests/test_rigs.py": RIGS, "tests/test_z_last.py": LAST}
    return write_project(folder, MISSION, TESTS.format(notices=notices, many=many), more=more)


@pytest.fixture
def always(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also small suites leave tests out."""
    monkeypatch.setattr(confirmation, "LEAST", 0.0)


def campaign(folder: Path, **changes: object) -> tuple[list[Outcome], list[str]]:
    quiet = Quiet()
    with Journal.open(run_campaign(request_for(folder, **changes), quiet)) as journal:
        return journal.outcomes(), quiet.lines


#: that engines agree is for the corpus; here both leave tests out, each in its way
ENGINE = pytest.mark.parametrize("engine", ["fork", REPLAY])


@pytest.fixture
def half(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of what was let through is confirmed, however long anything takes here: one that is wrong, too."""
    monkeypatch.setattr(
        confirmation, "_affordable", lambda campaign, by_id, left, seconds: left[: len(left) // 2]
    )


@pytest.mark.usefixtures("always", "half")
@ENGINE
@pytest.mark.parametrize("notices", ["pass", NOTICES])
@pytest.mark.whole  # `campaign/engines/test_confirmation.py` states the rules, without processes
def test_verdicts_are_those_of_plain_pytest(tmp_path: Path, engine: str, notices: str) -> None:
    found = compare(project(tmp_path / "many", notices), engines=(engine,))
    assert found.disagreements == []
    assert len(found.compared) >= 18
    assert {verdict.plain.state for verdict in found.compared} == {"passes", "fails"}


@pytest.mark.usefixtures("always")
@ENGINE
@pytest.mark.whole
def test_fixtures_live_as_long_as_in_the_whole_suite(tmp_path: Path, engine: str) -> None:
    """Else what is run without some tests fails, and all would be run with the whole suite."""
    outcomes, _ = campaign(project(tmp_path), engine=engine)
    waves = [outcome for outcome in outcomes if ":wave:" in outcome.mutant]
    assert {wave.verdict for wave in waves} == {Verdict.SURVIVED}
    assert {wave.confirmed for wave in waves} <= {True, False}
    assert {wave.tests for wave in waves if not wave.confirmed} <= {4}
    others = {
        outcome.confirmed
        for outcome in outcomes
        if ":wave:" not in outcome.mutant and ":store:" not in outcome.mutant
    }
    assert others == {None}  # killed or let through by the whole suite
