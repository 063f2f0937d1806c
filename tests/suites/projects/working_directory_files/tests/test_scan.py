import os
from pathlib import Path

import mission
import pytest
from robot import Sensor


@pytest.fixture
def workplace(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_one_file_each(workplace):
    mission.scan(Sensor(), count=4)
    assert len(os.listdir("scans")) == 4


def test_values(workplace):
    mission.scan(Sensor())
    assert Path("scans/0.txt").read_text() == "25.0"
    assert Path("scans/2.txt").read_text() == "55.0"


@pytest.mark.usefixtures("workplace")
class TestLaser:
    def test_laser_is_off(self):
        sensor = Sensor()
        mission.scan(sensor, count=1)
        assert not sensor.lit
