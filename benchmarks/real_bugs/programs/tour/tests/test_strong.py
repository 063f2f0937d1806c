"""Speeds, limits, folding, stopping, and names that nobody knows."""

import pytest
from program import POSES, Tour


def watched(cell, joint):
    """The least and the greatest angle that a joint is seen to have, degrees."""
    seen = []

    def look():
        seen.append(cell.sensors.joint_angles()[joint])
        return True

    cell.always(look, "a joint is watched")
    return seen


def test_a_careful_tour_is_slow(new_cell, mutabot_seed):
    times = []
    for careful in (False, True):
        cell = new_cell(mutabot_seed)
        tour = Tour(cell)
        tour.careful = careful
        tour.visit(["conveyor"])
        times.append(cell.time)
    assert times[1] > 2 * times[0]


def test_an_unknown_pose_is_left_out(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    assert Tour(cell).visit(["moon", "conveyor"]) == ["conveyor"]


def test_a_second_tour_begins_anew(new_cell, mutabot_seed):
    tour = Tour(new_cell(mutabot_seed))
    first = tour.visit(["conveyor"])
    assert tour.visit(["home"]) == ["home"]
    assert first == ["conveyor"]


def test_it_is_at_a_pose_whatever_the_turn(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    tour = Tour(cell)
    tour.visit(["conveyor"])
    turned = [angle + 360 if number == 2 else angle for number, angle in enumerate(POSES["conveyor"])]
    assert tour.is_at(turned)
    assert not tour.is_at(POSES["camera"])


@pytest.mark.parametrize("swing", [20, -20])
def test_it_waves_to_one_side_and_ends_where_it_began(new_cell, mutabot_seed, swing):
    cell = new_cell(mutabot_seed)
    seen = watched(cell, 0)
    answers = iter([False, True])
    before = cell.arm.commanded_joints()
    Tour(cell).wave(0, swing, lambda: next(answers))
    assert cell.arm.commanded_joints() == pytest.approx(before)
    assert (max(seen) if swing > 0 else min(seen)) == pytest.approx(before[0] + swing, abs=0.5)


def test_it_waves_slowly(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    answers = iter([False, True])
    Tour(cell).wave(0, 30, lambda: next(answers))
    assert cell.time > 2.5


def test_it_waves_within_its_limits(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    tour = Tour(cell)
    tour.visit(["conveyor"])
    seen = watched(cell, 5)
    answers = iter([False, True])
    tour.wave(5, -60, lambda: next(answers))
    assert min(seen) == pytest.approx(-115, abs=0.5)


def test_it_does_not_wave_when_told_to_stop_before(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    assert Tour(cell).wave(0, 10, lambda: True) == 0
    assert cell.time == 0


def test_it_stops_on_the_way(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    tour = Tour(cell)
    assert tour.creep("table", lambda: cell.time > 1.0)
    assert not tour.is_at(POSES["table"])
    assert cell.time < 2.0
    cell.wait(0.5)
    assert cell.truth.tool_speed() < 0.01


def test_what_is_never_seen_stops_nothing(new_cell, mutabot_seed):
    tour = Tour(new_cell(mutabot_seed))
    assert not tour.creep("conveyor", lambda: False)
    assert tour.is_at(POSES["conveyor"])


def test_it_creeps_slowly(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    Tour(cell).creep("camera", lambda: False)
    assert cell.time > 3.0
