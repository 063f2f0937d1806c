from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import mutabot_cell
from mutabot_cell import (
    BadArgument,
    Cell,
    CellError,
    ConditionBroken,
    SimulationDiverged,
    SimulatorMissing,
    simulated_time,
    world,
)
from mutabot_cell.simulation import TICK, Simulation

pytest_plugins = ["pytester"]


def state(cell: Cell) -> bytes:
    return cell.simulation.data.qpos.tobytes() + cell.simulation.data.qvel.tobytes()


def test_same_seed_gives_a_bit_identical_run(grip: Callable[[Cell], None]) -> None:
    runs = []
    for _ in range(2):
        cell = Cell(seed=4)
        grip(cell)
        cell.arm.home()
        runs.append((state(cell), cell.sensors.box_position(), cell.sensors.tool_pose(), cell.time))
    assert runs[0] == runs[1]


def test_seeds_differ() -> None:
    first, second = Cell(seed=4), Cell(seed=5)
    assert first.truth.box_position() != second.truth.box_position()
    assert first.sensors.tool_pose() != second.sensors.tool_pose()


def test_tick_returns_the_simulated_time(cell: Cell) -> None:
    assert cell.simulation.tick() == pytest.approx(TICK)
    assert cell.simulation.tick() == cell.time == pytest.approx(2 * TICK)


def test_every_advance_of_time_goes_through_tick(cell: Cell, monkeypatch: pytest.MonkeyPatch) -> None:
    passed = []
    original = cell.simulation.tick

    def tick(simulation: Simulation, most: int = 1) -> float:
        before = simulation.time
        now = original(most)
        passed.append(now - before)
        return now

    monkeypatch.setattr(Simulation, "tick", tick)
    cell.arm.move_by(y=0.05)
    cell.gripper.command(0.5, wait=True)
    cell.wait(0.2)
    assert sum(passed) == pytest.approx(cell.time)


@pytest.mark.parametrize("seconds", [-1.0, float("nan"), float("inf"), "1"])
def test_waiting_needs_a_sensible_time(cell: Cell, seconds: object) -> None:
    with pytest.raises(BadArgument, match="seconds"):
        cell.wait(seconds)  # type: ignore[arg-type]


def test_sleep_is_simulated_inside_and_real_outside(cell: Cell, monkeypatch: pytest.MonkeyPatch) -> None:
    slept: list[float] = []
    monkeypatch.setattr(time, "sleep", slept.append)
    with simulated_time(cell):
        time.sleep(20)
    assert time.sleep == slept.append
    assert cell.time == pytest.approx(20)
    assert slept == []


def test_sleep_is_real_again_after_an_error(cell: Cell) -> None:
    real = time.sleep

    def fail() -> None:
        with simulated_time(cell):
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert time.sleep is real


def test_condition_breaks_at_the_moment_with_time_and_values(
    cell: Cell, grip: Callable[[Cell], None]
) -> None:
    cell.always(
        lambda: cell.truth.box_position().z < 1.1,
        "the box stays low",
        values=lambda: {"z": cell.truth.box_position().z},
    )
    grip(cell)
    with pytest.raises(
        ConditionBroken, match=r"'the box stays low' broke at t=\d+\.\d\d s: z=1\.1"
    ) as broken:
        cell.arm.move_by(z=0.2)
    assert broken.value.values["z"] == pytest.approx(1.1, abs=0.01)
    assert broken.value.time == cell.time
    assert isinstance(broken.value, AssertionError)


def test_condition_that_does_not_hold_at_first_breaks_at_once(cell: Cell) -> None:
    with pytest.raises(ConditionBroken):
        cell.always(lambda: False, "never true")


def test_swallowed_condition_is_raised_at_the_end(cell: Cell) -> None:
    def swallow() -> None:
        with cell:
            cell.always(lambda: cell.time < 0.5, "half a second")
            try:
                cell.wait(1.0)
            except AssertionError:
                cell.wait(1.0)

    with pytest.raises(ConditionBroken) as broken:
        swallow()
    assert broken.value.time == pytest.approx(0.5)
    with pytest.raises(ConditionBroken):
        cell.verify()


def test_another_error_is_not_hidden_by_a_broken_condition(cell: Cell) -> None:
    def fail() -> None:
        with cell:
            cell.monitors.broken.append(ConditionBroken(name="a", time=0.0, values={}))
            raise KeyError

    with pytest.raises(KeyError):
        fail()


def test_condition_that_is_no_longer_watched_does_not_break(cell: Cell) -> None:
    condition = cell.always(lambda: cell.time < 0.5, "half a second")
    cell.monitors.forget(condition)
    cell.wait(1.0)
    cell.verify()


def test_swallowed_condition_fails_the_test_through_the_fixtures(pytester: pytest.Pytester) -> None:
    pytester.makeconftest("from mutabot_cell.fixtures import *")
    pytester.makepyfile(
        """
        import time
        def test_mission(new_cell):
            cell = new_cell(seed=1)
            cell.always(lambda: cell.time < 0.5, "half a second")
            try:
                time.sleep(1)
            except AssertionError:
                pass
        def test_next(new_cell):
            pass
        """
    )
    result = pytester.runpytest_inprocess("-p", "no:cacheprovider")
    result.assert_outcomes(failed=1, passed=1)
    result.stdout.fnmatch_lines(["*'half a second' broke at t=0.50 s*"])


def test_nan_is_a_failure_of_the_simulation_and_leaves_no_file(
    cell: Cell, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    cell.simulation.data.qvel[0] = np.nan
    with pytest.raises(SimulationDiverged) as diverged:
        cell.wait(0.1)
    assert not isinstance(diverged.value, AssertionError)
    assert not list(tmp_path.iterdir())


def test_absurd_speeds_are_a_failure_of_the_simulation(cell: Cell) -> None:
    cell.simulation.data.qvel[-1] = 1e7
    with pytest.raises(SimulationDiverged, match="largest speed"):
        cell.wait(0.1)


def test_world_is_the_flat_true_state_of_the_latest_cell(cell: Cell) -> None:
    cell.wait(0.1)
    seen = world()
    assert seen["time"] == pytest.approx(0.1)
    assert seen["box.z"] == pytest.approx(1.0, abs=0.001)
    assert {"box.x", "box.y", "box.tilt", "tool.x", "tool.theta_z", "opening"} <= set(seen)
    assert all(type(value) is float for value in seen.values())


def test_speeds_of_tool_and_box_are_those_of_their_places_from_tick_to_tick(
    cell: Cell, grip: Callable[[Cell], None]
) -> None:
    grip(cell)
    places: list[tuple[float, ...]] = []
    speeds: list[tuple[float, float]] = []

    def note() -> None:
        tool, box = cell.truth.tool_position(), cell.truth.box_position()
        places.append((cell.time, tool.x, tool.y, tool.z, box.x, box.y, box.z))
        speeds.append((cell.truth.tool_speed(), cell.truth.box_speed()))

    cell.simulation.after_tick.append(note)
    cell.arm.move_by(z=0.1)
    steps = np.diff(np.array(places), axis=0)
    travelled = np.stack([np.hypot(*steps[:, 2:4].T), np.hypot(*steps[:, 5:7].T)], axis=1) / steps[:, :1]
    assert travelled.max() > 0.2
    assert np.array(speeds)[1:] == pytest.approx(travelled, abs=0.02)


def test_every_public_name_exists() -> None:
    assert all(hasattr(mutabot_cell, name) for name in mutabot_cell.__all__)
    with pytest.raises(AttributeError, match="Robot"):
        mutabot_cell.Robot  # noqa: B018


def test_all_errors_have_one_base() -> None:
    for error in (BadArgument, ConditionBroken, SimulationDiverged, SimulatorMissing):
        assert issubclass(error, CellError)


def run_python(code: str) -> str:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    environment.pop("OPENBLAS_NUM_THREADS", None)
    result = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        capture_output=True,
        text=True,
        env=environment,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    return result.stdout


def test_importing_the_package_loads_neither_simulator_nor_planner() -> None:
    heavy = "['mujoco', 'numpy', 'mink', 'ruckig', 'scipy']"
    assert run_python(f"import sys, mutabot_cell; print([m for m in {heavy} if m in sys.modules])") == "[]\n"


def test_first_motion_loads_no_library_so_processes_forked_before_it_need_not() -> None:
    code = (
        "import sys, mutabot_cell as c; cell = c.Cell(1); before = set(sys.modules)\n"
        "cell.arm.move_by(y=0.1)\n"
        "known = ('mink', 'ruckig', 'scipy', 'qpsolvers', 'daqp', 'mujoco')\n"
        "print([m for m in set(sys.modules) - before if m.split('.')[0] in known])"
    )
    assert run_python(code) == "[]\n"


def test_missing_simulator_says_what_to_install() -> None:
    code = (
        "import sys; sys.modules['mujoco'] = None\n"
        "import mutabot_cell as cells\n"
        "try: cells.Cell\n"
        "except cells.SimulatorMissing as error: print(error)"
    )
    assert "install mutabot with its extra 'cells'" in run_python(code)


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs Linux's /proc")
def test_process_has_one_thread_after_a_motion_so_it_may_fork() -> None:
    code = (
        "from mutabot_cell import Cell\n"
        "Cell(1).arm.move_by(y=0.1)\n"
        "print([l.split()[1] for l in open('/proc/self/status') if l.startswith('Threads')][0])"
    )
    assert run_python(code) == "1\n"


def test_putting_models_together_writes_nothing_into_the_working_directory(tmp_path: Path) -> None:
    """MuJoCo writes its warnings there."""
    code = "import mutabot_cell; from mutabot_cell.models.assembly import build_robot as build\n"
    code += "build(mutabot_cell.gen3())"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert (list(tmp_path.iterdir()), done.stderr) == ([], "")


def test_no_time_is_spent_on_measuring_how_long_steps_take(cell: Cell) -> None:
    cell.wait(0.1)
    assert [timer.duration for timer in cell.simulation.data.timer if timer.duration] == []
    assert cell.simulation.data.timer[0].number
