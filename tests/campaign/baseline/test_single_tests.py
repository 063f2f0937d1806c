"""Campaigns of single tests: what other tests read from a result is no mistake of the vocabulary."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from mutabot.campaign.checking import check
from mutabot.config.configuration import load_configuration
from mutabot.errors import VocabularyError
from tests.campaign.project import Quiet, request_for, write_project

ROBOT = """
    class Sensor:
        def __init__(self, readings): self.readings = readings
        def get(self): return self.readings
"""
MISSION = """
    def distance(sensor): return sensor.get()["front"]
    def charge(sensor): return sensor.get()["percent"]
"""
TESTS = """
    import mission, robot

    def test_distance():
        assert mission.distance(robot.Sensor({"front": 300})) == 300

    def test_charge():
        assert mission.charge(robot.Sensor({"percent": 80})) == 80
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Sensor.get"
    result."['front']" = { kind = "distance", unit = "mm" }
    result."['percent']" = { kind = "number" }
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    return write_project(tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY)


def test_a_part_that_only_other_tests_read_is_a_note(project: Path) -> None:
    (whole,) = load_configuration(project).tests
    request = request_for(project)
    single = request.configuration.model_copy(update={"tests": (f"{whole}/test_mission.py::test_distance",)})
    report = check(replace(request, configuration=single), Quiet())
    (note,) = (line for line in report.lines if line.startswith("note "))
    assert "result.['percent']: no result had it: only single tests are run" in note


def test_a_part_that_no_test_of_the_suite_reads_is_a_mistake(project: Path) -> None:
    (project / "robot.toml").write_text((project / "robot.toml").read_text().replace("percent", "procent"))
    with pytest.raises(VocabularyError, match="procent"):
        check(request_for(project), Quiet())
