"""The first test writes a file in the working directory, the second reads it, the last removes it."""

import json
from pathlib import Path

import mission
from robot import Belt, Camera


def test_inspect(monkeypatch, tmp_path_factory):
    Path("report.json").unlink(missing_ok=True)
    belt = Belt()
    mission.inspect_part(Camera(belt), belt)


def test_report_has_two_parts():
    assert len(json.loads(Path("report.json").read_text())) == 2


def test_report_names_the_bolt_first():
    assert json.loads(Path("report.json").read_text())[0] == "bolt"


def test_second_run_is_added():
    belt = Belt()
    mission.inspect_part(Camera(belt), belt)
    assert len(json.loads(Path("report.json").read_text())) == 4


def teardown_module():
    Path("report.json").unlink()
