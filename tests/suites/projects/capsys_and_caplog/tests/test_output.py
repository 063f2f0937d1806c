import logging

import mission
import pytest
import robot


def test_prints_the_colour(capsys):
    mission.inspect_box(robot.Camera("red"), robot.Arm())
    assert capsys.readouterr().out == "box is red\n"


def test_warns_of_blue(caplog):
    mission.inspect_box(robot.Camera("blue"), robot.Arm())
    assert "blue box at 0.30 m" in caplog.text


def test_says_when_it_is_done(caplog):
    with caplog.at_level(logging.INFO):
        mission.inspect_box(robot.Camera("green"), robot.Arm())
    assert caplog.messages == ["done"]


def test_with_a_patched_camera(monkeypatch, capfd):
    monkeypatch.setattr(robot.Camera, "colour", lambda self: "red")
    arm = robot.Arm()
    mission.inspect_box(robot.Camera("blue"), arm)
    assert arm.z == pytest.approx(0.5)
    assert "red" in capfd.readouterr().out
