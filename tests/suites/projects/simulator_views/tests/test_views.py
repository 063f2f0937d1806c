import mission
import pytest
from robot import Sim


def test_place():
    sim = Sim()
    mission.place_box(sim)
    assert sim.memory[5] == 0.25


def test_nudge():
    sim = Sim()
    mission.nudge_box(sim)
    assert sim.memory[3] == pytest.approx(0.9)


def test_raise():
    sim = Sim()
    mission.raise_tool(sim)
    assert sim.went == pytest.approx([0.1, 0.2, 0.4])


def test_high():
    assert mission.is_high(Sim())
