"""The instructions and functions of KRL: motions, waits, ``BAS``, triggers and mathematics."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from typing import Any

from mutabot_languages.core.frames import Frame
from mutabot_languages.core.interrupts import HANDLERS, Interrupt
from mutabot_languages.core.names import name_set
from mutabot_languages.core.scope import RoutineScope, Steps, Structure
from mutabot_languages.core.station import ProgramPlace
from mutabot_languages.core.task import OF_DEGREES, ProgramTask, end_program, of_values, pause
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.errors import UnreachableError

from .dialect import frame_of, machine_of, of_axes, of_frame, set_frame

#: what has no effect in the cell, and is noted
IGNORED = name_set(
    """continue a10 a10_ini a20 a50 h70 h50 userspot bas_tq msgnotify msgquit msgloop msgdialog set_kr_msg
    set_kr_dlg clear_kr_msg varstate ir_stopm user_grp usergrp a_10 a_20 spottech grp err_raise cwrite
    cast_to set_torque_limits reset_torque_limits delete_backward_buffer lk_ping use_cm_pro_values
    err_clear setbreakpoint sync_cmd on_error_proceed programsync lock unlock tech_motion kcp_ippno chkgrp
    interrupt_off interrupt_on bwini sb_ini vw cwrite_text kuka_notify p00 act_drive_bus"""
)

#: what INVERSE says where no axes reach a position: anything but 0 is an error
_NO_AXES = 3
_AXES = ("a1", "a2", "a3", "a4", "a5", "a6", "e1")


def _angles(task: ProgramTask, value: Any) -> list[float]:
    """Return joint angles of an axis position; axes that are not named stay."""
    now = [math.degrees(angle) for angle in task.station.cell.arm.setpoint]
    return [float(value.get(name, angle)) for name, angle in zip(_AXES, now, strict=False)]


def _is_axes(value: Any) -> bool:
    return isinstance(value, dict) and not value.keys().isdisjoint(_AXES[:6])


def _complete(task: ProgramTask, value: Any, site: ProgramPlace) -> Frame:
    """Return the frame of a target; components that it does not name stay as they are."""
    if not isinstance(value, dict):
        raise TypeError(f"expected a position {{X …}} or axes {{A1 …}}, found {value!r}")
    base = machine_of(task).base
    named = {name: part for name, part in value.items() if name in tuple("xyzabc")}
    if len(named) < 6:  # else nothing is read
        named = {**of_frame(base.inverse() * task.station.commanded(site), "frame"), **named}
    return base * frame_of(named)


def _move(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out PTP, LIN, CIRC, their splines, and all of them relative."""
    yield from _with(task, node, scope)
    machine, station, site = machine_of(task), task.station, task.site(node, scope)
    targets = yield from task.values(node.plain, scope)
    options = node.options
    name = node.name
    kind = name.removesuffix("_rel").lstrip("s") if name not in ("spl", "spl_rel") else "lin"
    kind = "ptp" if kind in ("tp", "async_ptp") else kind
    if name.endswith("_rel"):
        start = station.commanded(site)
        targets = [_relative(task, point, options, start) for point in targets]
    if kind == "ptp" and _is_axes(targets[0]):
        yield from task.move(node, scope, station.joint_move(_angles(task, targets[0]), machine.pace[1]))
    else:
        frames = [
            point if isinstance(point, Frame) else station.forward(_angles(task, point)) if _is_axes(point)
            else _complete(task, point, site)
            for point in targets
        ]  # fmt: skip
        if kind == "ptp":
            yield from task.move(node, scope, station.joint_move_to(frames[0], machine.pace[1]))
        elif kind == "circ" and len(frames) > 1:
            for motion in station.arc(station.commanded(site), frames[0], frames[1], machine.pace[0]):
                yield from task.move(node, scope, motion)
        else:
            yield from task.move(node, scope, station.line(frames[0], machine.pace[0]))
    yield from _fire(task)


def _relative(task: ProgramTask, value: Any, options: dict[str, ProgramNode], start: Frame) -> Any:
    """Return the target of a relative motion: in the axes of the base, or of the tool."""
    if _is_axes(value):
        now = [math.degrees(angle) for angle in task.station.cell.arm.setpoint]
        return of_axes([item + float(value.get(name, 0.0)) for name, item in zip(_AXES, now, strict=False)])
    shift = frame_of({"x": 0.0, **value})
    frame = options.get("frame")
    if frame is not None and frame.parts[0].name == "tool":
        return start * shift
    base = machine_of(task).base
    here = base.inverse() * start
    moved = tuple(p + q for p, q in zip(here.position, shift.position, strict=True))
    turned = Frame(rotation=shift.rotation) * Frame(rotation=here.rotation)
    return base * Frame((moved[0], moved[1], moved[2]), turned.rotation)


def _with(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Set system variables for one spline motion."""
    for option in node.parts:
        if option.kind == "option" and option.name == "with":
            target, value = option.parts
            yield from task.store(target, (yield from task.value(value, scope)), scope)


def spline(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out the motions of a spline block, one after the other."""
    yield from task.run(node.bodies[0], scope)


def _trigger(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> None:
    """Do what a trigger does at the end of the next motion."""
    machine_of(task).triggers.append((node.bodies[0][0], scope))


def _fire(task: ProgramTask) -> Steps:
    machine = machine_of(task)
    waiting, machine.triggers = machine.triggers, []
    for action, scope in waiting:
        yield from task.statement(action, scope)


def _wait_for(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    yield from task.until(node, scope, lambda: task.value(node.parts[0], scope))


def _halt(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> None:
    task.station.note(f"HALT at line {scope.unit.source.line_of(node.start)}: the program goes on here")


def _pulse(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    target, value, seconds = node.parts[0], *(yield from task.values(node.parts[1:3], scope))
    yield from task.store(target, value, scope)
    yield from task.wait(node, scope, float(seconds))
    yield from task.store(target, not value, scope)


def _interrupt(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out INTERRUPT DECL, ON, OFF, ENABLE and DISABLE; that with IR_STOPM has no effect."""
    interrupts = task.machine.interrupts
    is_inert = node.bodies and node.bodies[0][0].name == "ir_stopm"
    numbers = [int(number) for number in (yield from task.values(node.parts[:1], scope))]
    if node.name == "interrupt decl" and not is_inert:
        handlers = type(task)(task.machine, HANDLERS)
        condition, action = node.parts[1], node.bodies[0][0]

        def holds() -> Steps:
            return task.dialect.truth((yield from handlers.value(condition, scope)))

        made = Interrupt(holds, True, lambda: handlers.statement(action, scope), is_awake=False)
        interrupts.known[numbers[0]] = made
        if HANDLERS not in task.machine.tasks:
            task.machine.start(HANDLERS, interrupts.steps(task.site(node, scope)))
        return
    chosen = [candidate for number, candidate in interrupts.known.items() if not numbers or number in numbers]
    for interrupt in chosen:
        interrupt.is_awake = node.name in ("interrupt on", "interrupt enable")
    if is_inert or not chosen:
        task.note_without_effect(node, scope)


def _stop(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> None:
    """Refuse BRAKE and RESUME in an interrupt's routine; elsewhere they have no effect."""
    if task.name == HANDLERS:
        raise task.unsupported(node, scope, node.name.upper())
    task.note_without_effect(node, scope)


def _bas(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out BAS(#COMMAND, value), by which inline forms set values before a motion."""
    command = node.parts[0].name if node.parts and node.parts[0].kind == "enum" else ""
    value = 0.0
    if len(node.parts) > 1 and node.parts[1].kind != "omitted":
        value = yield from task.value(node.parts[1], scope)
    machine = machine_of(task)
    if command == "initmov":
        machine.pace[:] = [0.25, 1.0]
    elif command in ("vel_ptp", "ptp_params"):
        machine.pace[1] = max(0.01, float(value) / 100)
    elif command in ("vel_cp", "cp_params"):
        machine.pace[0] = float(value)
    elif command in ("tool", "base"):
        _number_frame(task, f"${command}", int(value))
    elif command == "frames":
        _forms(task, scope)
    elif command not in _BAS:
        raise task.unsupported(node, scope, f"BAS(#{command.upper()})")


_BAS = name_set("acc_ptp acc_cp acc_gluing ptp_dat cp_dat vel_sptp out_sync out_async ex_base ext_motion")


def _forms(task: ProgramTask, scope: RoutineScope) -> None:
    """Set tool and base from the data of the inline form, ``FDAT_ACT``."""
    found = task.find("fdat_act", scope)
    if found is None or not isinstance(found.value, dict):
        return
    for name, key in (("$tool", "tool_no"), ("$base", "base_no")):
        if key in found.value:
            _number_frame(task, name, int(found.value[key]))


def _number_frame(task: ProgramTask, name: str, number: int) -> None:
    """Set the tool or the base by its number; 0 and below stand for none."""
    machine = machine_of(task)
    table = f"{name[1:]}_data"
    variable = task.machine.globals.get(table)
    value: Any = machine.system.get(f"{table}[{number}]")
    if value is None and variable is not None and isinstance(variable.value, list):
        value = variable.value[number - 1] if 0 < number <= len(variable.value) else None
    if value is None and number > 0:
        task.station.note(f"{table.upper()}[{number}] is not declared: it is taken for zero")
    set_frame(machine, name, value if value else of_frame(Frame(), "frame"))


def _forward(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    values, _ = yield from task.arguments(node, scope)
    at = machine_of(task).base.inverse() * task.station.forward(_angles(task, values[0]))
    if len(values) > 1:
        yield from task.store(node.parts[1], 0, scope)
    return of_frame(at, "e6pos")


def _inverse(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out INVERSE: axes for a position that are nearest to others; the last argument says if any."""
    values, _ = yield from task.arguments(node, scope)
    start = _angles(task, values[1]) if len(values) > 1 and _is_axes(values[1]) else None
    try:
        found = task.station.inverse(machine_of(task).base * frame_of(values[0]), start)
    except UnreachableError:
        if len(values) < 3:
            raise
        yield from task.store(node.parts[2], _NO_AXES, scope)
        return of_axes(_angles(task, {}))
    if len(values) > 2:
        yield from task.store(node.parts[2], 0, scope)
    return of_axes(found)


def _inverse_position(value: Any) -> Structure:
    return of_frame(frame_of(value).inverse(), "frame")


_MOVES = """ptp lin circ ptp_rel lin_rel circ_rel sptp slin scirc spl sptp_rel slin_rel scirc_rel spl_rel"""

FUNCTIONS: dict[str, Callable[..., Any]] = {
    **dict.fromkeys(_MOVES.split(), _move), "wait sec": pause, "wait for": _wait_for, "halt": _halt,
    "brake": _stop, "resume": _stop, "pulse": _pulse, "trigger": _trigger, "bas": _bas, "cancel": end_program,
    **dict.fromkeys(
        ("interrupt decl", "interrupt on", "interrupt off", "interrupt enable", "interrupt disable"),
        _interrupt
    ),
    "forward": _forward, "inverse": _inverse, "inv_pos": of_values(_inverse_position),
    "abs": of_values(abs), "sqrt": of_values(math.sqrt),
    **{name: of_values(function) for name, function in OF_DEGREES.items()},
    "round": of_values(lambda value: math.floor(value + 0.5)), "trunc": of_values(math.trunc),
    "strlen": of_values(len), "strdecllen": of_values(len),
    "strcomp": of_values(lambda first, second, *_: first == second),
    "strclear": of_values(lambda *_: True),
    "toint": of_values(int), "copy": of_values(copy.deepcopy),
    **dict.fromkeys(("svel_joint", "sacc_cp", "sacc_joint", "sgear_jerk"), of_values(float)),
    **dict.fromkeys(
        ["sori_typ", "svel_cp", "stool2", "sbase", "sload", "sipo_mode", "sapo", "sapo_ptp", "tool_adj"],
        of_values(lambda value, *_: value),
    ),
    "sjerk": of_values(lambda *_: 0.0),
}  # fmt: skip
