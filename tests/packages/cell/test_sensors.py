from __future__ import annotations

import statistics

import pytest

from mutabot_cell import BadArgument, Box, Cell, Scene, SensorError


def test_noise_has_the_stated_size(cell: Cell) -> None:
    readings = []
    for _ in range(400):
        cell.simulation.advance(0.04)
        readings.append(cell.sensors.box_position().x)
    exact = cell.truth.box_position().x
    assert statistics.mean(readings) == pytest.approx(exact, abs=0.0001)
    assert statistics.stdev(readings) == pytest.approx(0.0005, rel=0.15)


def test_noise_can_be_switched_off(exact_cell: Cell) -> None:
    assert exact_cell.sensors.box_position() == exact_cell.truth.box_position()
    seen, exact = exact_cell.sensors.tool_pose(), exact_cell.truth.tool_pose()
    assert (seen.x, seen.y, seen.z) == pytest.approx((exact.x, exact.y, exact.z), abs=1e-9)


def test_one_more_reading_of_one_sensor_does_not_shift_the_others() -> None:
    first, second = Cell(seed=5), Cell(seed=5)
    second.sensors.tool_pose()
    second.sensors.distance()
    assert first.sensors.box_position() == second.sensors.box_position()
    assert first.sensors.joint_angles() == second.sensors.joint_angles()


def test_placement_and_colour_do_not_depend_on_noise() -> None:
    with_noise, without = Cell(seed=6), Cell(seed=6, noise=False)
    assert with_noise.truth.box_position() == without.truth.box_position()
    assert with_noise.sensors.colour_number() == without.sensors.colour_number()


def test_colour_is_a_number_from_1_to_10_whose_parity_is_the_label() -> None:
    numbers = {}
    for seed in range(120):
        sensors = Cell(seed).sensors
        numbers[sensors.colour_number()] = sensors.colour()
        assert sensors.colour_number() == sensors.colour_number()
        if set(numbers) == set(range(1, 11)):
            break
    assert numbers == {number: "red" if number % 2 == 0 else "blue" for number in range(1, 11)}


@pytest.mark.parametrize("colour", ["red", "blue"])
def test_colour_can_be_given(colour: str) -> None:
    for seed in range(8):
        cell = Cell(seed, scene=Scene(parts=(Box(colour=colour),)))
        assert cell.sensors.colour() == colour
        assert 1 <= cell.sensors.colour_number() <= 10


def test_box_is_placed_within_two_millimetres() -> None:
    places = [Cell(seed).truth.box_position() for seed in range(30)]
    assert all(abs(place.x - 0.55) <= 0.001 and abs(place.y - 0.2) <= 0.001 for place in places)
    assert len({place.x for place in places}) == 30


def test_joint_angles_are_the_home_angles(exact_cell: Cell) -> None:
    assert exact_cell.sensors.joint_angles() == pytest.approx((0, 15, 180, -130, 0, 55, 90))


def test_distance_sees_the_conveyor_below_and_not_its_own_fingers(exact_cell: Cell) -> None:
    exact_cell.arm.move_by(y=-0.2, z=-0.1)
    exact_cell.arm.move_by(theta_x=90)
    exact_cell.wait(0.5)
    tool = exact_cell.truth.tool_pose()
    palm_height = tool.z + 0.9 + 0.035
    assert exact_cell.sensors.distance() == pytest.approx(palm_height - 1.0, abs=0.002)


def test_distance_sees_the_box(exact_cell: Cell) -> None:
    exact_cell.arm.move_by(y=0.2, z=-0.1)
    exact_cell.arm.move_by(theta_x=90)
    exact_cell.arm.move_by(x=-0.027)
    exact_cell.wait(0.5)
    palm_height = exact_cell.truth.tool_pose().z + 0.9 + 0.035
    assert exact_cell.sensors.distance() == pytest.approx(palm_height - 1.05, abs=0.002)


def test_distance_reads_its_upper_end_where_nothing_is(exact_cell: Cell) -> None:
    assert exact_cell.sensors.distance() == 2.0


def test_missing_box_is_a_sensor_error_that_lists_the_boxes(cell: Cell) -> None:
    with pytest.raises(SensorError, match="there are: box"):
        cell.sensors.box_position("lid")
    with pytest.raises(SensorError, match="none"):
        Cell(1, scene=Scene(parts=())).sensors.colour()


def test_several_boxes_are_distinguished() -> None:
    boxes = (Box(name="left", position=(0.5, 0.3, 1.0)), Box(name="right", position=(0.5, -0.3, 1.0)))
    sensors = Cell(2, scene=Scene(parts=boxes)).sensors
    assert sensors.box_position("left").y == pytest.approx(0.3, abs=0.005)
    assert sensors.box_position("right").y == pytest.approx(-0.3, abs=0.005)


def test_unknown_colour_and_seed_are_refused() -> None:
    with pytest.raises(BadArgument, match="green"):
        Cell(1, scene=Scene(parts=(Box(colour="green"),)))
    with pytest.raises(BadArgument, match="seed"):
        Cell("one")  # type: ignore[arg-type]


def test_the_encoder_shows_where_the_belt_was_when_the_camera_took_its_picture() -> None:
    """So a box on a moving belt is where the picture showed it plus what the belt has run since."""
    cell = Cell(1, noise=False, scene=Scene(parts=(Box(position=(0.55, -0.6, 1.0), jitter=0.0),)))
    belt = cell.belt()
    belt.run(0.2)
    cell.wait(1.0)
    for _ in range(20):
        cell.simulation.tick()
        age = cell.time - cell.sensors.picture_time()
        assert 0.04 <= age + 1e-9 <= 0.07 + 2e-9
        seen = cell.sensors.box_position().y + belt.position() - belt.position(cell.sensors.picture_time())
        count, stale = 1e-4, 0.2 * 0.002  # places are those at the beginning of a physics step
        assert seen == pytest.approx(cell.truth.box_position().y, abs=count + stale)
