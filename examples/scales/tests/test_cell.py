"""The cell itself, so that verdicts mean something: what it refuses, and what it forgives."""

from __future__ import annotations

import link
import pytest
from cell import FLOOR, Cell, ProtectiveStop, Refused, UnknownCommand
from scales import Loads, loads


@pytest.fixture
def holding(cell: Cell) -> Cell:
    """The cell with the box in the gripper, 5 cm up."""
    for text in ("pick", "lift/5"):
        link.send(text)
    return cell


@pytest.mark.parametrize("text", ["pic", "PICK", "pick/5", "lift", "lift/", "lift/five", "turn 90", ""])
def test_unknown_commands_are_refused(cell: Cell, text: str) -> None:
    before = cell.world
    with pytest.raises(UnknownCommand):
        link.send(text)
    assert cell.world == before


@pytest.mark.parametrize("text", ["lift/12.5", "lift/-1", "drop/1", "turn/361", "turn/-90", "turn/nan"])
def test_values_out_of_range_are_refused(cell: Cell, text: str) -> None:
    before = cell.world
    with pytest.raises(Refused):
        link.send(text)
    assert cell.world == before


def test_unknown_readings_are_refused(cell: Cell) -> None:
    with pytest.raises(UnknownCommand):
        link.read("weight/middle")


def test_turning_below_the_rims_is_a_protective_stop(cell: Cell) -> None:
    link.send("pick")
    with pytest.raises(ProtectiveStop, match="rim"):
        link.send("turn/90")


@pytest.mark.parametrize("angle", ["90", "91", "85"])
def test_a_degree_more_or_less_changes_nothing_that_matters(holding: Cell, angle: str) -> None:
    for text in (f"turn/{angle}", "drop/5", "release"):
        link.send(text)
    assert loads() == Loads(left=True, right=False)


@pytest.mark.usefixtures("holding")
def test_a_box_in_the_gripper_weighs_nothing() -> None:
    for text in ("turn/90", "drop/5"):
        link.send(text)
    assert loads() == Loads(left=False, right=False)


def test_a_box_released_in_mid_air_falls(holding: Cell) -> None:
    link.send("release")
    assert holding.box.z == 0.0
    assert not holding.holding


def test_a_box_released_beside_everything_falls_to_the_floor(holding: Cell) -> None:
    for text in ("turn/180", "release"):
        link.send(text)
    assert holding.box.z == FLOOR
    assert loads() == Loads(left=False, right=False)


def test_a_box_out_of_reach_is_not_picked(holding: Cell) -> None:
    for text in ("turn/90", "release", "turn/270", "drop/5", "pick"):
        link.send(text)
    assert not holding.holding


def test_the_scales_weigh_the_box_within_their_noise(holding: Cell) -> None:
    for text in ("turn/90", "drop/5", "release"):
        link.send(text)
    weights = [float(link.read("weight/left")) for _ in range(100)]
    assert sum(weights) / 100 == pytest.approx(holding.box.mass, abs=0.3)
    assert len(set(weights)) > 5


def test_commands_take_simulated_time(holding: Cell) -> None:
    assert holding.time == pytest.approx(1.0)
    link.send("turn/270")
    assert holding.time == pytest.approx(2.5)
    assert (link.read("height"), link.read("heading")) == ("5.0", "270.0")
