"""A belt carries by friction, counts what it has run, and wanders only if told to."""

from __future__ import annotations

import math
import statistics
from dataclasses import replace

import pytest

from mutabot_cell import BadArgument, Belt, Box, Cell, Scene, SensorError
from mutabot_cell.scene import CONVEYOR, TARGET_TABLE

GRAVITY = 9.81
START = Box(position=(0.55, -0.8, 1.0), jitter=0.0)


def cell_with(belt: Belt, box: Box = START) -> Cell:
    return Cell(1, scene=Scene(fixtures=(replace(CONVEYOR, belt=belt), TARGET_TABLE), parts=(box,)))


def carried(cell: Cell, seconds: float) -> float:
    """How far the box comes meanwhile, m."""
    before = cell.truth.box_position().y
    cell.wait(seconds)
    return cell.truth.box_position().y - before


def test_a_box_on_the_belt_travels_with_it() -> None:
    """The drive accelerates less than friction can: 0.5 m/s² against 0.6 g."""
    cell = cell_with(Belt(acceleration=0.5))
    cell.belt().run(0.2)
    cell.wait(1.0)
    assert carried(cell, 2.0) == pytest.approx(0.4, abs=2e-4)
    assert cell.truth.box_position().z == pytest.approx(1.0, abs=1e-4), "it neither sinks nor rises"
    assert cell.truth.box_position().x == pytest.approx(0.55, abs=1e-4)


def test_a_box_on_a_belt_that_jerks_slips_by_what_coulomb_says() -> None:
    """Until it has the belt's speed it is pulled with mu g: it stays behind by v² / (2 mu g)."""
    speed = 0.4
    for friction in (0.6, 0.1):
        cell = cell_with(Belt(acceleration=100.0), replace(START, friction=friction))
        cell.belt().run(speed)
        behind = cell.truth.belt_position() + speed * 1.0 - carried(cell, 1.0)
        assert behind == pytest.approx(speed**2 / (2 * friction * GRAVITY), rel=0.05)


def test_a_box_without_friction_stays_while_the_belt_runs_under_it() -> None:
    """As far as MuJoCo can: its smallest coefficient is 0.00001."""
    cell = cell_with(Belt(), replace(START, friction=0.0))
    cell.belt().run(0.3)
    assert 0.0 <= carried(cell, 2.0) <= 1e-5 * GRAVITY * 2.0**2 / 2


def many(height: float) -> tuple[Box, ...]:
    """A row of boxes along the belt, a second layer on it, and one box that lies elsewhere."""
    row = [(0.3 + 0.1 * number, -0.8, height) for number in range(5)]
    upper = [(x, y, z + 0.05) for x, y, z in row]
    places = [*row, *upper, (-0.6, 0.3, 0.76)]
    return tuple(Box(name=f"box {index}", position=place, jitter=0.0) for index, place in enumerate(places))


def test_parts_that_sleep_on_a_belt_are_carried_when_it_starts_and_the_others_sleep_on() -> None:
    cell = Cell(1, scene=Scene(parts=many(1.0)))
    cell.wait(3.0)
    asleep = cell.simulation.data.nbody_awake
    before = [cell.truth.box_position(f"box {index}").y for index in range(11)]
    cell.belt().run(0.1)
    cell.wait(1.0)
    assert cell.simulation.data.nbody_awake == asleep + 10
    cell.belt().stop()
    cell.wait(3.0)
    moved = [cell.truth.box_position(f"box {index}").y - y for index, y in enumerate(before)]
    assert moved[:10] == pytest.approx([cell.truth.belt_position()] * 10, abs=5e-4)
    assert moved[10] == 0.0
    assert cell.simulation.data.nbody_awake == asleep, "on a belt that stands they sleep again"


def test_the_belt_reaches_its_speed_and_rest_as_its_acceleration_says() -> None:
    cell = cell_with(Belt(acceleration=0.25))
    belt = cell.belt()
    belt.run(0.2)
    cell.wait(0.4)
    assert cell.truth.belt_speed() == pytest.approx(0.1)
    cell.wait(0.4)
    assert (cell.truth.belt_speed(), belt.commanded()) == pytest.approx((0.2, 0.2))
    belt.stop()
    cell.wait(0.4)
    assert cell.truth.belt_speed() == pytest.approx(0.1)
    cell.wait(0.5)
    assert cell.truth.belt_speed() == 0.0
    assert carried(cell, 0.5) == pytest.approx(0.0, abs=1e-4)
    braking = 2 * 0.2**2 / (2 * 0.25)
    assert cell.truth.belt_position() == pytest.approx(braking, abs=0.2 * 0.01)


def test_the_encoder_counts_whole_steps_of_what_the_belt_has_run() -> None:
    belt_data = Belt(resolution=0.002)
    cell = cell_with(belt_data)
    belt = cell.belt("conveyor")
    belt.run(0.15)
    for _ in range(100):
        cell.simulation.tick()
        read, true = belt.position(), cell.truth.belt_position()
        assert 0.0 <= true - read + 1e-9 < belt_data.resolution + 1e-9
        assert read / belt_data.resolution == pytest.approx(round(read / belt_data.resolution))
    assert belt.speed() == pytest.approx(0.15, abs=belt_data.resolution / 0.1)


def test_the_encoder_shows_what_it_read_when_a_picture_was_taken() -> None:
    cell = cell_with(Belt())
    belt = cell.belt()
    belt.run(0.2)
    read = []
    for _ in range(50):
        read.append((cell.time, belt.position()))
        cell.simulation.tick()
    assert all(belt.position(at=time) == pytest.approx(position, abs=1e-9) for time, position in read)


def test_the_encoder_knows_neither_the_future_nor_what_is_long_ago() -> None:
    cell = cell_with(Belt())
    cell.wait(6.0)
    for time in (6.1, 0.5, -1.0):
        with pytest.raises(SensorError, match=f"was asked for t={time} s"):
            cell.belt().position(at=time)


def test_a_belt_runs_evenly_unless_its_drive_is_said_to_wander() -> None:
    cell = cell_with(Belt())
    cell.belt().run(0.2)
    cell.wait(1.0)
    speeds = []
    for _ in range(200):
        cell.simulation.tick()
        speeds.append(cell.truth.belt_speed())
    assert set(speeds) == {0.2}


def test_a_wandering_drive_has_the_deviation_and_the_memory_it_was_given() -> None:
    """Ornstein and Uhlenbeck: deviation sigma, correlation exp(-t / tau)."""
    jitter, memory = 0.05, 0.2
    fixture = replace(CONVEYOR, belt=Belt(jitter=jitter, jitter_time=memory))
    cell = Cell(1, scene=Scene(fixtures=(fixture,), parts=()))
    cell.belt().run(0.1)
    cell.wait(1.0)
    speeds = []
    for _ in range(10000):
        cell.simulation.tick()
        speeds.append(cell.truth.belt_speed() / 0.1 - 1)
    assert statistics.pstdev(speeds) == pytest.approx(jitter, rel=0.15)
    lag = round(memory / 0.01)
    assert statistics.correlation(speeds[:-lag], speeds[lag:]) == pytest.approx(math.exp(-1), abs=0.1)


def test_the_same_seed_wanders_the_same_way_and_another_seed_another_way() -> None:
    ends = []
    for seed in (1, 1, 2):
        scene = Scene(fixtures=(replace(CONVEYOR, belt=Belt(jitter=0.1)),), parts=())
        cell = Cell(seed, scene=scene)
        cell.belt().run(0.2)
        cell.wait(2.0)
        ends.append(cell.truth.belt_position())
    assert ends[0] == ends[1] != ends[2]


@pytest.mark.parametrize("speed", [0.51, -0.51, math.nan, "0.1", None, True])
def test_a_speed_that_the_drive_does_not_have_is_refused(speed: object) -> None:
    with pytest.raises(BadArgument, match=r"-0\.5 <= speed <= 0\.5 m/s"):
        cell_with(Belt()).belt().run(speed)  # type: ignore[arg-type]


def test_a_belt_that_is_not_there_is_refused_by_name() -> None:
    with pytest.raises(BadArgument, match=r"\(conveyor\) but got name='other'"):
        Cell(1).belt("other")
    with pytest.raises(BadArgument, match=r"\(conveyor\) but got name='other'"):
        Cell(1).truth.belt_speed("other")
