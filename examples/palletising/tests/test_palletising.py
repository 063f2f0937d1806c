"""Does every box end in its place, and does the robot stop when something is not as it should be?"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import palletising
import pytest
from handling import Outcome
from layout import BASE_HEIGHT, BELT_TOP, BOX, SIZE, at_slot, on_belt
from palletising import Report
from pattern import slots
from readings import belt_speed_after, belt_travel_after, box_after, tool_after, vacuum_after

from mutabot_cell import Box, Cell, Pose
from mutabot_cell.placing import move_fixture

CellWith = Callable[..., Cell]

HOME = Pose(0.5767, 0.0014, 0.4337, 90.0, 0.0, 90.0)
"""Base frame; the maker's figures."""
HOME_WITHIN, HOME_WITHIN_DEGREES = 0.0015, 0.3
"""As in ../pick_and_place."""
PLACED_WITHIN = 0.0045
"""What the box may lie beside the cup, 1 mm, the arm's error, 1 mm, and five times the camera's noise."""
RESTING_WITHIN = 0.0025
"""Of a box's height: five times the camera's noise."""
STANDING = 0.0015
"""The belt stands when its encoder counts less than this, m/s: a count of 0.1 mm in 0.1 s, and a half."""
TURNED_WITHIN = 1.0
"""Degrees: how a box may lie at the stop, and turn on the cup."""
NO_VACUUM = 1e3
"""Five times the sensor's noise, Pa."""
HOLDING_VACUUM = 35e3
"""Three times what a box of 0.8 kg needs on 30 mm, Pa."""
LEAK, SMALL_LEAK, TORN_LIP = 1e-6, 5e-7, 1e-5
"""Openings, m²: vacuum comes to less than the switch needs; to 38 kPa; to nothing that holds."""
CYCLE_TIME = 8.0
"""From box to box, s."""
TWO_CYCLES = 24.3
"""From home with two boxes on the belt, and the patience at the end, s; rounded up."""
TWO_TRIES = 8.6
"""As above, for a box at the stop on which no vacuum comes."""
BRAKING, BRAKING_TIME = 0.22, 0.55
"""From where vacuum begins to fall the arm comes to rest within this way, m, and time, s: the switch notices
after 0.1 s, and the arm brakes for 0.4 s, from at most 0.65 m/s."""
AT_STOP = replace(BOX, name="box 1", position=(0.5, 0.0, BELT_TOP))


@pytest.mark.parametrize("placed", [0, 5, 14])
def test_a_box_is_set_down_in_the_next_place_of_the_pattern(cell_with: CellWith, placed: int) -> None:
    cell = cell_with(placed=placed)

    assert palletising.run(cell, placed) == Report(Outcome.NO_BOX, placed + 1)

    check_placed(cell, "box 1", placed)
    check_at_rest(cell)


def test_the_last_box_makes_the_pallet_full_and_the_next_one_stays_on_the_belt(cell_with: CellWith) -> None:
    cell = cell_with(on_belt(2), placed=26)

    assert palletising.run(cell, 26) == Report(Outcome.FULL, 27)

    check_placed(cell, "box 1", 26)
    assert box_after(cell, "box 2").z == pytest.approx(BELT_TOP, abs=RESTING_WITHIN)
    check_at_rest(cell)


@pytest.mark.whole
def test_a_whole_pallet_is_filled_and_stands(cell_with: CellWith) -> None:
    cell = cell_with(on_belt(27))

    assert palletising.run(cell) == Report(Outcome.FULL, 27)

    assert cell.time < 27 * CYCLE_TIME
    for number, slot in enumerate(slots(), start=1):
        box, place = cell.truth.box_position(f"box {number}"), at_slot(slot)
        assert (box.x, box.y, box.z) == pytest.approx(place, abs=PLACED_WITHIN)
    check_at_rest(cell)


def test_a_full_pallet_gets_no_box(cell_with: CellWith) -> None:
    cell = cell_with(placed=27)

    assert palletising.run(cell, 27) == Report(Outcome.FULL, 27)

    assert belt_travel_after(cell) == 0.0
    check_at_rest(cell)


def test_two_boxes_take_two_cycles_in_which_the_belt_runs_while_the_arm_carries(cell_with: CellWith) -> None:
    cell = cell_with(on_belt(2), placed=2)

    assert palletising.run(cell, 2) == Report(Outcome.NO_BOX, 4)

    assert cell.time < TWO_CYCLES
    check_placed(cell, "box 1", 2)
    check_placed(cell, "box 2", 3)
    check_at_rest(cell)


def test_the_belt_stops_when_the_next_box_comes_while_the_arm_still_carries(cell_with: CellWith) -> None:
    close_behind = replace(BOX, name="box 2", position=(0.5, -0.1, BELT_TOP))
    cell = cell_with([AT_STOP, close_behind])

    assert palletising.run(cell) == Report(Outcome.NO_BOX, 2)

    check_placed(cell, "box 1", 0)
    check_placed(cell, "box 2", 1)
    check_at_rest(cell)


def test_a_box_that_lies_at_the_stop_already_is_taken_before_the_belt_runs(cell_with: CellWith) -> None:
    cell = cell_with([AT_STOP])
    cell.always(lambda: not lies_at_stop(cell) or cell.truth.belt_position() == 0.0, "the belt waits")

    assert palletising.run(cell) == Report(Outcome.NO_BOX, 1)

    check_placed(cell, "box 1", 0)
    check_at_rest(cell)


def test_the_robot_may_have_been_left_over_the_pallet(cell_with: CellWith) -> None:
    cell = cell_with(placed=4)
    cell.arm.move_joints((-90, 32, 180, -87, 0, -61, 90))

    assert palletising.run(cell, 4) == Report(Outcome.NO_BOX, 5)

    check_placed(cell, "box 1", 4)
    check_at_rest(cell)


def test_without_boxes_the_belt_runs_for_a_while_and_stops(cell_with: CellWith) -> None:
    cell = cell_with([])

    assert palletising.run(cell) == Report(Outcome.NO_BOX, 0)

    assert 0.4 < belt_travel_after(cell) < 0.6
    check_at_rest(cell)


def test_a_box_further_away_on_the_belt_is_waited_for(cell_with: CellWith) -> None:
    cell = cell_with([replace(BOX, name="box 1", position=(0.5, -0.4, BELT_TOP))])

    assert palletising.run(cell) == Report(Outcome.NO_BOX, 1)

    check_placed(cell, "box 1", 0)
    check_at_rest(cell)


@pytest.mark.parametrize(
    ("pallet", "there", "told", "outcome"),
    [
        (False, 0, 0, Outcome.NO_PALLET),
        (True, 9, 0, Outcome.WRONG_COUNT),
        (True, 0, 9, Outcome.WRONG_COUNT),
    ],
)
def test_without_a_pallet_or_with_a_wrong_count_nothing_moves(
    cell_with: CellWith, pallet: bool, there: int, told: int, outcome: Outcome
) -> None:
    cell = cell_with(placed=there, pallet=pallet)

    assert palletising.run(cell, told) == Report(outcome, told)

    assert belt_travel_after(cell) == 0.0
    check_on_belt(cell, "box 1")
    check_at_rest(cell)


def test_a_pallet_that_is_taken_away_ends_the_run(cell_with: CellWith) -> None:
    cell = cell_with(on_belt(2), troubled=("box 1",))

    def take_away() -> None:
        if cell.truth.box_position("box 1").y > 0.4 and cell.truth.tool_position().y < 0.2:
            move_fixture(cell.simulation, "pallet", (-1.5, 0.48, 0.65), carried=["box 1"])
            cell.simulation.after_tick.remove(take_away)

    cell.simulation.after_tick.append(take_away)

    assert palletising.run(cell) == Report(Outcome.NO_PALLET, 1)

    check_on_belt(cell, "box 2")
    check_at_rest(cell)


@pytest.mark.parametrize("height", [0.06, 0.10])
def test_something_higher_or_lower_than_a_box_is_left_at_the_stop(cell_with: CellWith, height: float) -> None:
    cell = cell_with([replace(AT_STOP, size=(0.12, 0.08, height))])

    assert palletising.run(cell) == Report(Outcome.WRONG_BOX, 0)

    check_on_belt(cell, "box 1")
    check_at_rest(cell)


def test_a_cup_that_leaks_at_the_first_try_is_pressed_again_and_deeper(cell_with: CellWith) -> None:
    cell = cell_with([AT_STOP])
    cell.suction.leak = LEAK
    depths = [0.0]

    def seal_at_the_second_try() -> None:
        if not cell.suction.is_on() and cell.truth.vacuum() > 1e3:
            cell.suction.leak = 0.0
            depths.append(0.0)
        depths[-1] = max(depths[-1], float(cell.simulation.data.joint("plunger").qpos[0]))

    cell.simulation.after_tick.append(seal_at_the_second_try)

    assert palletising.run(cell) == Report(Outcome.NO_BOX, 1)

    assert depths[0] == pytest.approx(0.003, abs=0.001)
    check_placed(cell, "box 1", 0)
    check_at_rest(cell)


def test_a_box_on_which_no_vacuum_comes_is_left_at_the_stop(cell_with: CellWith) -> None:
    cell = cell_with([AT_STOP])
    cell.suction.leak = LEAK

    assert palletising.run(cell) == Report(Outcome.NO_VACUUM, 0)

    assert cell.time < TWO_TRIES
    check_at_stop(cell, "box 1")
    check_at_rest(cell)


@pytest.mark.parametrize("phase", ["lifting", "swinging", "over the pallet", "lowering"])
def test_when_vacuum_falls_the_arm_stops_and_the_box_still_hangs(cell_with: CellWith, phase: str) -> None:
    cell = cell_with([AT_STOP, *on_belt(1, first=2)], troubled=("box 1",))
    lost = leak_in(cell, phase, SMALL_LEAK)

    assert palletising.run(cell) == Report(Outcome.LOST, 0)

    check_stopped(cell, lost)
    assert vacuum_after(cell) > HOLDING_VACUUM
    tool, box = tool_after(cell), box_after(cell, "box 1")
    hangs = (tool.x, tool.y, tool.z + BASE_HEIGHT - SIZE[2])
    assert (box.x, box.y, box.z) == pytest.approx(hangs, abs=PLACED_WITHIN)


@pytest.mark.parametrize("phase", ["lifting", "swinging"])
def test_when_a_box_comes_off_the_robot_stops(cell_with: CellWith, phase: str) -> None:
    cell = cell_with([AT_STOP, *on_belt(1, first=2)], troubled=("box 1",))
    lost = leak_in(cell, phase, TORN_LIP)

    assert palletising.run(cell) == Report(Outcome.LOST, 0)

    check_stopped(cell, lost)


@pytest.mark.parametrize("thickness", [0.010, 0.025])
def test_what_lies_in_the_place_of_a_box_is_felt_and_the_box_taken_up_again(
    cell_with: CellWith, thickness: float
) -> None:
    x, y, z = at_slot(slots()[0])
    spanner = Box(name="spanner", size=(0.05, 0.02, thickness), position=(x, y, z))
    cell = cell_with([AT_STOP], others=[spanner])

    assert palletising.run(cell) == Report(Outcome.BLOCKED, 0)

    check_over(cell, "box 1", 0)


def test_a_box_is_not_set_down_where_nothing_is_below_it(cell_with: CellWith) -> None:
    cell = cell_with([AT_STOP], placed=5)

    assert palletising.run(cell, 9) == Report(Outcome.BLOCKED, 9)

    check_over(cell, "box 1", 9)


def test_a_box_that_the_cup_does_not_let_go_stays_where_it_was_set_down(
    cell_with: CellWith, monkeypatch: pytest.MonkeyPatch
) -> None:
    cell = cell_with([AT_STOP])
    monkeypatch.setattr(cell.suction, "off", lambda: None)  # the valve sticks

    assert palletising.run(cell) == Report(Outcome.NOT_RELEASED, 0)

    cell.wait(0.2)
    assert vacuum_after(cell) > HOLDING_VACUUM
    x, y, z = at_slot(slots()[0])
    tool = tool_after(cell)
    assert (tool.x, tool.y) == pytest.approx((x, y), abs=0.0015)
    assert tool.z + BASE_HEIGHT == pytest.approx(z + SIZE[2], abs=0.003)
    check_belt_stands(cell)


def test_a_light_barrier_that_is_not_free_after_lifting_stops_the_robot(cell_with: CellWith) -> None:
    litter = Box(name="litter", size=(0.02, 0.02, 0.06), position=(0.62, 0.03, BELT_TOP))
    cell = cell_with([AT_STOP], others=[litter])

    assert palletising.run(cell) == Report(Outcome.NOT_LIFTED, 0)

    tool = tool_after(cell)
    assert (tool.x, tool.y, tool.z) == pytest.approx((0.5, 0.0, 0.2), abs=0.0015)
    assert vacuum_after(cell) > HOLDING_VACUUM
    check_belt_stands(cell)


def lies_at_stop(cell: Cell) -> bool:
    """Whether box 1 has not been lifted yet."""
    box = cell.truth.box_position("box 1")
    return box.y < 0.02 and box.z < BELT_TOP + 0.02


def leak_in(cell: Cell, phase: str, leak: float) -> list[float]:
    """Let the cup leak in this phase of the first cycle; when it began and where the cup was (x, y, z)."""
    begun: list[float] = []

    def watch() -> None:
        tool, box = cell.truth.tool_position(), cell.truth.box_position("box 1")
        over_stop, over_pallet = tool.x > 0.49 and tool.y < 0.01, tool.y > 0.47 and tool.x < 0.05
        now = {
            "lifting": over_stop and box.z > BELT_TOP + 0.02,
            "swinging": tool.x > 0.3 and tool.y > 0.2,
            "over the pallet": over_pallet and tool.z > 0.19,
            "lowering": over_pallet and tool.z < 0.1,
        }
        if now[phase] and not begun:
            begun.extend((cell.time, tool.x, tool.y, tool.z))
            cell.suction.leak = leak

    cell.simulation.after_tick.append(watch)
    return begun


def check_stopped(cell: Cell, lost: list[float]) -> None:
    """The arm braked within the way and the time that it needs, and stays there; the belt stands."""
    assert lost, "the phase was reached"
    assert cell.time - lost[0] < BRAKING_TIME
    tool = tool_after(cell)
    assert math.dist((tool.x, tool.y, tool.z), lost[1:]) < BRAKING
    cell.wait(0.5)
    later = tool_after(cell)
    assert (later.x, later.y, later.z) == pytest.approx((tool.x, tool.y, tool.z), abs=0.001)
    check_belt_stands(cell)


def check_placed(cell: Cell, name: str, number: int) -> None:
    """The box lies in its place, so many before it, and is turned as it should."""
    box, (x, y, z) = box_after(cell, name), at_slot(slots()[number])
    assert (box.x, box.y) == pytest.approx((x, y), abs=PLACED_WITHIN)
    assert box.z == pytest.approx(z, abs=RESTING_WITHIN)
    turned = yaw(cell, name) - (90.0 if slots()[number].across else 0.0)
    assert (turned + 90.0) % 180.0 - 90.0 == pytest.approx(0.0, abs=TURNED_WITHIN)


def yaw(cell: Cell, name: str) -> float:
    """How the box is turned about the vertical, degrees."""
    across = cell.simulation.data.body(name).xmat
    return math.degrees(math.atan2(across[3], across[0]))


def check_over(cell: Cell, name: str, number: int) -> None:
    """The box hangs over its place, at the height at which boxes are carried; the belt stands."""
    tool, box = tool_after(cell), box_after(cell, name)
    x, y, _ = at_slot(slots()[number])
    assert (tool.x, tool.y, tool.z) == pytest.approx((x, y, 0.2), abs=0.0015)
    hangs = (x, y, tool.z + BASE_HEIGHT - SIZE[2])
    assert (box.x, box.y, box.z) == pytest.approx(hangs, abs=PLACED_WITHIN)
    check_belt_stands(cell)


def check_on_belt(cell: Cell, name: str) -> None:
    """The box lies on the belt."""
    assert box_after(cell, name).z == pytest.approx(BELT_TOP, abs=RESTING_WITHIN)


def check_at_stop(cell: Cell, name: str) -> None:
    """The box lies at the belt's stop."""
    box = box_after(cell, name)
    assert (box.x, box.y) == pytest.approx((0.5, 0.0), abs=PLACED_WITHIN)
    check_on_belt(cell, name)


def check_belt_stands(cell: Cell) -> None:
    """The belt stands."""
    assert belt_speed_after(cell) == pytest.approx(0.0, abs=STANDING)


def check_at_rest(cell: Cell) -> None:
    """The arm stands at home, the cup holds nothing, the belt stands."""
    pose = tool_after(cell)
    assert (pose.x, pose.y, pose.z) == pytest.approx((HOME.x, HOME.y, HOME.z), abs=HOME_WITHIN)
    angles = (pose.theta_x, pose.theta_y, pose.theta_z)
    assert angles == pytest.approx((HOME.theta_x, HOME.theta_y, HOME.theta_z), abs=HOME_WITHIN_DEGREES)
    assert vacuum_after(cell) == pytest.approx(0.0, abs=NO_VACUUM)
    check_belt_stands(cell)
