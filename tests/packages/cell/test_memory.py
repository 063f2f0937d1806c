"""What was computed once in a campaign is taken from memory, and nothing else is."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from mutabot.api.processes import SharedMemory
from mutabot_cell import Box, Cell, CellError, MotionRefused, Scene, gen3, stepping
from mutabot_cell.fingerprint import Fingerprint
from mutabot_cell.integrity import MOTIONS, CodeRecord, are_original
from mutabot_cell.motion.kinematics import Kinematics
from mutabot_cell.motion.trajectory import joint_motion

from .memory import remembering

STEPS = 5
"""Physics steps in a control tick."""


@pytest.fixture(autouse=True)
def _remember() -> Iterator[None]:
    with remembering():
        yield


@pytest.fixture
def steps(monkeypatch: pytest.MonkeyPatch) -> Callable[[], int]:
    """How many physics steps were carried out since it was last asked."""
    original, counted = mujoco.mj_step, [0]

    def step(*arguments: object) -> None:
        counted[0] += 1
        original(*arguments)

    def asked() -> int:
        count, counted[0] = counted[0], 0
        return count

    monkeypatch.setattr(mujoco, "mj_step", step)
    monkeypatch.setattr(
        CodeRecord, "are_unchanged", lambda *_: True
    )  # to count is to put something in its place
    return asked


def move(cell: Cell) -> int:
    """Move a little; how many ticks that takes."""
    before = cell.simulation.ticks
    cell.arm.move_by(z=0.02)
    return cell.simulation.ticks - before


def singly(cell: Cell) -> Cell:
    """A cell with a condition under watch is stepped tick by tick."""
    cell.always(lambda: True, "true")
    return cell


def test_a_tick_that_was_stepped_before_takes_one_step(steps: Callable[[], int]) -> None:
    ticks = move(singly(Cell(1)))
    assert steps() == STEPS * ticks
    assert move(singly(Cell(1))) == ticks
    assert steps() == ticks


def test_a_stretch_that_was_stepped_before_takes_few_steps(steps: Callable[[], int]) -> None:
    ticks = move(Cell(1))
    assert steps() == STEPS * ticks
    assert move(Cell(1)) == ticks
    assert steps() < ticks / 2


def test_another_seed_is_stepped_anew(steps: Callable[[], int]) -> None:
    move(Cell(1))
    steps()
    assert STEPS * move(Cell(2)) == steps()


def heavier(cell: Cell) -> None:
    cell.simulation.model.body("box").mass[:] *= 1.001


def pushed(cell: Cell) -> None:
    cell.simulation.data.xfrc_applied[cell.simulation.id_of("body", "box"), 2] = 0.1


def moved(cell: Cell) -> None:
    cell.simulation.data.qvel[-1] += 1e-9


def at_the_moon(cell: Cell) -> None:
    cell.simulation.model.opt.gravity[2] = -1.62


@pytest.mark.parametrize("change", [heavier, pushed, moved, at_the_moon])
@pytest.mark.parametrize("prepared", [singly, lambda cell: cell], ids=["tick by tick", "in stretches"])
def test_what_is_changed_by_hand_is_stepped_anew(
    change: Callable[[Cell], None], prepared: Callable[[Cell], Cell], steps: Callable[[], int]
) -> None:
    move(prepared(Cell(1)))
    cell = prepared(Cell(1))
    change(cell)
    steps()
    assert STEPS * move(cell) == steps()


@pytest.mark.parametrize("prepared", [singly, lambda cell: cell], ids=["tick by tick", "in stretches"])
def test_where_a_callback_acts_on_the_physics_all_is_stepped(
    prepared: Callable[[Cell], Cell], steps: Callable[[], int]
) -> None:
    """What it does is not known."""
    move(prepared(Cell(1)))
    cell = prepared(Cell(1))
    steps()
    mujoco.set_mjcb_passive(lambda model, data: None)
    try:
        assert STEPS * move(cell) == steps()
    finally:
        mujoco.set_mjcb_passive(None)


def test_whatever_is_changed_in_a_model_changes_its_fingerprint() -> None:
    model = Cell(1).simulation.model
    fingerprint = Fingerprint(model)
    same, changed = [], 0
    for owner in (model, model.opt):
        for name in (name for name in dir(owner) if not name.startswith("_")):
            value, before = getattr(owner, name), fingerprint.now()
            assert fingerprint.now() == before
            if isinstance(value, np.ndarray) and value.size and value.flags.writeable:
                value.flat[0] = not value.flat[0] if value.dtype == bool else value.flat[0] + 1
            elif isinstance(value, bool | int | float):
                try:
                    setattr(owner, name, not value if isinstance(value, bool) else value + 1)
                except AttributeError:  # sizes cannot be changed
                    continue
            else:
                continue
            changed += 1
            if fingerprint.now() == before:
                same.append(name)
    assert same == []
    assert changed > 200


def test_where_parts_may_sleep_all_is_stepped(steps: Callable[[], int]) -> None:
    """Which of them do is no part of the state."""
    boxes = tuple(Box(name=f"box {number}", position=(0.1 * number, 0.6, 1.0)) for number in range(4))
    for _ in range(2):
        assert STEPS * move(Cell(1, scene=Scene(parts=boxes))) == steps()


def test_from_where_parts_may_sleep_on_all_is_stepped(steps: Callable[[], int]) -> None:
    for _ in range(2):
        cell = Cell(1)
        cell.simulation.model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
        assert STEPS * move(cell) == steps()


@pytest.mark.parametrize("prepared", [singly, lambda cell: cell], ids=["tick by tick", "in stretches"])
def test_after_another_time_step_was_set_ticks_are_remembered(
    prepared: Callable[[Cell], Cell], steps: Callable[[], int]
) -> None:
    for _ in range(2):
        cell = prepared(Cell(1))
        cell.simulation.model.opt.timestep = 0.001
        ticks = move(cell)
        counted = steps()
    assert counted <= ticks


def test_a_tick_in_which_mujoco_begins_anew_is_not_kept() -> None:
    """It then clears more than changes in a tick otherwise."""
    ends = []
    for _ in range(2):
        cell = singly(Cell(1))
        cell.simulation.data.qfrc_applied[-1] = np.nan
        with suppress(CellError):
            cell.wait(0.05)
        ends.append((cell.simulation.data.time, cell.simulation.data.qpos.tobytes()))
    assert ends[0] == ends[1]


def test_a_motion_is_planned_once(monkeypatch: pytest.MonkeyPatch) -> None:
    planned = []
    original = Kinematics.follow

    def follow(self: Kinematics, *given: object) -> object:
        planned.append(given)
        return original(self, *given)

    monkeypatch.setattr(Kinematics, "follow", follow)
    monkeypatch.setattr(CodeRecord, "are_unchanged", lambda *_: True)  # although it was put in place
    for _ in range(2):
        cell = Cell(1)
        cell.arm.move_by(z=0.02)
        cell.arm.move_by(z=0.02)
        cell.arm.home()
    assert len(planned) == 2
    Cell(1).arm.move_by(z=0.02, speed=0.5)
    Cell(1).arm.move_by(z=0.02, theta_x=1.0)
    assert len(planned) == 4


def test_a_robot_of_shorter_reach_is_refused_what_another_one_planned() -> None:
    robot = gen3()
    assert robot.reach is not None
    short = replace(robot, reach=replace(robot.reach, length=0.4 * robot.reach.length))
    Cell(1, robot=robot).arm.move_by(z=0.02)
    with pytest.raises(MotionRefused):
        Cell(1, robot=short).arm.move_by(z=0.02)


def test_a_plan_from_memory_is_the_plan_to_the_bit() -> None:
    first, second = (Cell(1).arm._planner.between(np.zeros(7), np.full(7, 0.1), 0.7) for _ in range(2))
    assert first.joints.tobytes() == second.joints.tobytes()
    assert first.speeds.tobytes() == second.speeds.tobytes()
    assert first.joints.shape == second.joints.shape


def fields(cell: Cell) -> bytes:
    """Where everything is."""
    return cell.simulation.data.qpos.tobytes()


def disturbed(cell: Cell) -> Callable[..., None]:
    """A step of the physics in whose course somebody takes the box away."""
    original = mujoco.mj_step

    def step(model: mujoco.MjModel, data: mujoco.MjData, *more: object) -> None:
        data.qpos[-7] += 1e-4
        original(model, data, *more)

    return step


@pytest.mark.parametrize("watch", [singly, lambda cell: cell], ids=["ticks", "stretches"])
def test_what_was_stepped_by_something_else_is_not_remembered(
    watch: Callable[[Cell], Cell], monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = watch(Cell(1))
    with monkeypatch.context() as patch:
        patch.setattr(SharedMemory, "_current", None)
        plain = watch(Cell(1))
        move(plain)
    with monkeypatch.context() as patch:
        other = watch(Cell(1))
        patch.setattr(mujoco, "mj_step", disturbed(other))
        move(other)
        assert fields(other) != fields(plain)
    again = watch(Cell(1))
    move(again)
    assert fields(again) == fields(plain)
    with monkeypatch.context() as patch:  # nor is what is remembered put in the place of something else
        other_again = watch(Cell(1))
        patch.setattr(mujoco, "mj_step", disturbed(other_again))
        move(other_again)
        assert fields(other_again) == fields(other)


@pytest.mark.parametrize(
    "target",
    [
        "mujoco.mj_step", "mujoco.mj_setState", "mujoco.mj_getState", "mujoco.mj_saveModel",
        "mutabot_cell.stepping.Stepping.step", "mutabot_cell.stepping.Stepping.end",
        "mutabot_cell.fingerprint.Fingerprint.now", "mutabot_cell.stepping.MOVING",
    ],
)  # fmt: skip
def test_ticks_are_remembered_only_while_all_that_makes_them_is_in_place(
    target: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert stepping._ORIGINALS.are_unchanged()
    with monkeypatch.context() as patch:
        patch.setattr(target, object())
        assert not stepping._ORIGINALS.are_unchanged()
    assert stepping._ORIGINALS.are_unchanged()


@pytest.mark.parametrize(
    "target",
    [
        "mutabot_cell.motion.planning.Planner.along", "mutabot_cell.motion.trajectory.joint_motion",
        "mutabot_cell.motion.kinematics.Kinematics.follow", "mutabot_cell.motion.trajectory.ruckig",
        "ruckig.Ruckig", "numpy.linalg.norm", "mink.Configuration", "math.sqrt",
    ],
)  # fmt: skip
def test_motions_are_remembered_only_while_all_that_plans_them_is_in_place(
    target: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert are_original(MOTIONS)
    with monkeypatch.context() as patch:
        patch.setattr(target, object())
        assert not are_original(MOTIONS)
    assert are_original(MOTIONS)


def test_other_code_in_a_function_and_a_method_of_one_object_count_as_well(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    planner = Cell(1).arm._planner
    assert are_original(MOTIONS, planner)
    monkeypatch.setattr(planner, "between", object())
    assert not are_original(MOTIONS, planner)
    monkeypatch.undo()
    monkeypatch.setattr(joint_motion, "__code__", (lambda: None).__code__)
    assert not are_original(MOTIONS)


def test_a_callback_that_c_code_has_set_is_seen() -> None:
    library = ctypes.PyDLL(mujoco._functions.__file__)
    pointer = ctypes.c_void_p.in_dll(library, "mjcb_control")
    callback = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(lambda model, data: None)
    assert stepping._is_native()
    pointer.value = ctypes.cast(callback, ctypes.c_void_p).value
    try:
        assert not stepping._is_native()
    finally:
        pointer.value = None
    assert stepping._is_native()
