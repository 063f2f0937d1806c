"""Programs of several robots share a clock: they take turns, wait for each other, and end together."""

from __future__ import annotations

import pytest

from mutabot_cell import BadArgument, Cell, Pose, ProgramsStuck, Scene, gen3, run_together, until

FACING = Pose(1.5, 0.0, 0.9, 0.0, 0.0, 180.0)


@pytest.fixture
def cell() -> Cell:
    return Cell(robots={"left": gen3(), "right": gen3().at(FACING)}, scene=Scene((), (), ()))


async def move(cell: Cell, name: str, y: float) -> float:
    moved = cell.robots[name].arm.start_move_by(y=y)
    await until(cell, lambda: moved.done)
    return cell.time


def test_both_arms_move_at_the_same_time(cell: Cell) -> None:
    alone = Cell(scene=Scene((), (), ()))
    alone.arm.move_by(y=0.2)
    ends = run_together(cell, {"left": move(cell, "left", 0.2), "right": move(cell, "right", 0.1)}, within=10)
    assert ends["right"] < ends["left"] <= alone.time
    assert cell.robots["left"].arm.commanded_pose().y == pytest.approx(0.2014, abs=0.001)
    assert cell.robots["right"].arm.commanded_pose().y == pytest.approx(0.1014, abs=0.001)


def test_a_program_waits_for_what_another_one_does(cell: Cell) -> None:
    done: list[str] = []

    async def first() -> None:
        await until(cell, lambda: done, within=5.0)
        done.append("first")

    async def second() -> None:
        await move(cell, "right", 0.1)
        done.append("second")

    run_together(cell, {"first": first(), "second": second()}, within=10)
    assert done == ["second", "first"]


def test_waiting_ends_when_its_time_is_over(cell: Cell) -> None:
    async def wait() -> bool:
        return await until(cell, lambda: False, within=0.25)

    assert run_together(cell, {"left": wait()}, within=10) == {"left": False}
    assert cell.time == pytest.approx(0.25)


def test_programs_that_wait_for_each_other_are_named(cell: Cell) -> None:
    async def wait() -> None:
        await until(cell, lambda: False)

    async def end() -> None:
        return

    with pytest.raises(ProgramsStuck, match=r"still wait at t=0\.50 s: left, right") as found:
        run_together(cell, {"right": wait(), "left": wait(), "third": end()}, within=0.5)
    assert found.value.names == ("left", "right")


def test_the_order_within_a_tick_is_drawn_from_the_seed(cell: Cell) -> None:
    def orders(seed: int) -> str:
        seen: list[str] = []

        async def program(name: str) -> None:
            for _ in range(20):
                seen.append(name)
                await until(cell, lambda: False, within=0.01)

        run_together(cell, {"a": program("a"), "b": program("b")}, within=10, seed=seed)
        return "".join(seen)

    assert orders(1) == orders(1)
    assert len({orders(seed) for seed in range(3)}) == 3


def test_an_error_of_one_program_ends_the_others(cell: Cell) -> None:
    ended: list[str] = []

    async def fail() -> None:
        await until(cell, lambda: cell.time > 0.1)
        raise RuntimeError("broken")

    async def wait() -> None:
        try:
            await until(cell, lambda: False)
        finally:
            ended.append("wait")

    with pytest.raises(RuntimeError, match="broken"):
        run_together(cell, {"left": fail(), "right": wait()}, within=10)
    assert ended == ["wait"]


def test_no_program_is_refused(cell: Cell) -> None:
    with pytest.raises(BadArgument, match="Expected programs and a time"):
        run_together(cell, {}, within=10)


def test_a_move_that_is_ordered_to_brake_ends_soon_and_short_of_its_target(cell: Cell) -> None:
    arm = cell.robots["left"].arm
    moved = arm.start_move_by(y=0.3)
    cell.wait(0.5)
    start = cell.time
    moved.brake()
    assert cell.time == start
    assert not moved.done
    cell.wait(0.5)
    assert moved.done
    assert 0.01 < arm.commanded_pose().y < 0.25


def test_a_robot_begins_at_the_home_position_it_is_given() -> None:
    angles = (10.0, 26.0, 180.0, -78.0, 0.0, -76.0, 90.0)
    cell = Cell(robot=gen3().with_home(angles), scene=Scene((), (), ()), noise=False)
    assert cell.sensors.joint_angles() == pytest.approx(angles, abs=0.01)
    with pytest.raises(BadArgument, match="7 joint angles"):
        gen3().with_home((1.0, 2.0))
