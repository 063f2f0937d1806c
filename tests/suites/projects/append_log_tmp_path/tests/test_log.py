import mission
import pytest
from robot import Arm


@pytest.fixture
def log(tmp_path):
    return tmp_path / "run.log"


def test_lines(log):
    mission.run(Arm(), log)
    assert log.read_text().splitlines() == ["start", "at 0.25", "at 0.50", "end"]


def test_four_lines_after_an_aborted_run(log):
    log.write_text("start\n")
    arm = Arm()
    mission.run(arm, log)
    assert len(log.read_text().splitlines()) == 5
    assert arm.x == 0.0
