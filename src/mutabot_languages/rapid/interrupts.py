"""Interrupts and triggers of RAPID: CONNECT, ISignalDI, ITimer, and TriggIO along a motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any

from mutabot_languages.core.frames import Frame
from mutabot_languages.core.interrupts import HANDLERS, Interrupt
from mutabot_languages.core.scope import ProgramRaised, RoutineScope, Steps
from mutabot_languages.core.task import ProgramTask
from mutabot_languages.core.tree import ProgramNode


def _number(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Hashable:
    """Return a key for an interrupt: the identity of its variable; of an element, its text as written."""
    found = task.find(node.name, scope) if node.kind == "name" else None
    if found is not None:
        return id(found)
    if node.kind == "name":
        raise task.error(node, scope, f"there is no interrupt {node.name}")
    return "".join(scope.unit.source.text[node.start : node.end].lower().split())


def _traps(task: ProgramTask) -> dict[Hashable, Callable[[], Steps]]:
    machine: Any = task.machine
    if not hasattr(machine, "traps"):
        machine.traps = {}
    found: dict[Hashable, Callable[[], Steps]] = machine.traps
    return found


def _connect(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> None:
    number, (variable, name) = _number(task, node.parts[0], scope), node.parts
    routine = task.find_routine(name.name, scope)
    if routine is None:
        raise task.error(node, scope, f"there is no trap {name.name}")
    if number in _traps(task):
        raise ProgramRaised("err_alrdycnt", f"the interrupt {variable.name} is connected already")
    handlers = type(task)(task.machine, HANDLERS)
    _traps(task)[number] = lambda: handlers.call_routine(routine, [], name, scope)


def _order(
    task: ProgramTask, node: ProgramNode, scope: RoutineScope, value: Callable[[], Steps], wanted: Any
) -> None:
    parts, options = node.plain, node.options
    number = _number(task, parts[-1], scope)
    if number not in _traps(task):
        raise ProgramRaised("err_unkino", f"the interrupt {parts[-1].name} is connected to no trap")
    interrupts = task.machine.interrupts
    is_single = bool({"single", "singlesafe"} & set(options))
    interrupts.known[number] = Interrupt(value, wanted, _traps(task)[number], is_single)
    if HANDLERS not in task.machine.tasks:
        task.machine.start(HANDLERS, interrupts.steps(task.site(node, scope)))


def _on_signal(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out ISignalDI and ISignalDO: when a signal becomes 0 or 1, or changes."""
    parts = node.plain
    station, name, site = task.station, parts[0].name, task.site(node, scope)
    wanted = float((yield from task.value(parts[1], scope)))

    def value() -> Steps:
        is_output = node.name == "isignaldo"
        return float(station.outputs.get(name, 0) if is_output else station.read(site, name))
        yield  # pragma: no cover  (makes it a generator)

    _order(task, node, scope, value, None if wanted == 2 else wanted)


def _timer(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    parts = node.plain
    seconds = float((yield from task.value(parts[0], scope)))
    if seconds <= 0:
        raise task.error(node, scope, f"a timer of {seconds:g} s")
    due = task.station.time + seconds

    def value() -> Steps:
        nonlocal due
        is_due = task.station.time >= due
        due += seconds * is_due
        return is_due
        yield  # pragma: no cover

    _order(task, node, scope, value, True)


def _change(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> None:
    """Carry out IDelete, ISleep and IWatch of an interrupt, or IDisable and IEnable of all."""
    interrupts = task.machine.interrupts
    if node.name in ("idisable", "ienable"):
        interrupts.are_enabled = node.name == "ienable"
        return
    number = _number(task, node.parts[0], scope)
    if node.name == "idelete":
        interrupts.known.pop(number, None)
        _traps(task).pop(number, None)
    elif number in interrupts.known:
        interrupts.known[number].is_awake = node.name == "iwatch"
    else:
        raise ProgramRaised("err_unkino", f"the interrupt {node.parts[0].name} is not ordered")


def _stop_move(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> None:
    """Refuse StopMove in a trap, where it stops a motion; anywhere else there is none to stop."""
    if task.name == HANDLERS:
        raise task.unsupported(node, scope, f"{node.name} in a trap")
    task.note_without_effect(node, scope)


@dataclass(frozen=True, slots=True)
class TriggerPoint:
    """Where on its way a motion does something.

    Attributes:
        metres: from the end, or from the start.
        is_from_start: which of them.
        act: does it.
    """

    metres: float
    is_from_start: bool
    act: Callable[[], object]


def _trigger(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out TriggIO and TriggEquip: what a later motion does where."""
    parts, options = node.plain, node.options
    distance = float((yield from task.value(parts[1], scope))) / 1000
    variable = task.find(parts[0].name, scope)
    if variable is None or "time" in options:
        raise task.unsupported(node, scope, f"{node.name} with Time" if variable else node.name)
    signal = next((options[option] for option in ("dop", "gop", "aop") if option in options), None)
    if signal is None:
        raise task.unsupported(node, scope, f"{node.name} without a signal")
    value = yield from task.value(parts[-1], scope)
    name, site = signal.parts[0].name, task.site(node, scope)
    variable.value = TriggerPoint(distance, "start" in options, lambda: task.station.write(site, name, value))


def trigger_watch(task: ProgramTask, points: list[Any], end: Frame) -> Callable[..., None]:
    """Return a function that does what is due, to call in each tick of a motion to ``end``, and after it."""
    station = task.station

    def here() -> Frame:
        return station.forward([math.degrees(angle) for angle in station.cell.arm.setpoint])

    start, waiting = here(), [point for point in points if isinstance(point, TriggerPoint)]

    def look(is_over: bool = False) -> None:
        at = here()
        for point in [*waiting]:
            from_start, to_end = start.distance(at) - point.metres, point.metres - at.distance(end)
            way = from_start if point.is_from_start else to_end
            if is_over or way >= 0:
                waiting.remove(point)
                point.act()

    return look


INTERRUPTS: dict[str, Callable[..., Any]] = {
    "connect": _connect, "isignaldi": _on_signal, "isignaldo": _on_signal, "itimer": _timer,
    **dict.fromkeys(("idelete", "isleep", "iwatch", "idisable", "ienable"), _change),
    **dict.fromkeys(("stopmove", "startmove", "storepath", "restopath", "clearpath"), _stop_move),
    **dict.fromkeys(("triggio", "triggequip"), _trigger),
}  # fmt: skip
