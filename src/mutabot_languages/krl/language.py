"""KRL as a language that mutabot knows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mutabot_languages.core.language import RobotLanguage
from mutabot_languages.core.machine import Machine
from mutabot_languages.core.scope import ProgramUnit, Routine, RoutineScope, Steps, Variable
from mutabot_languages.core.task import ProgramTask, call_main, declare_data
from mutabot_languages.core.tree import ProgramNode

from .dialect import KrlDialect, KrlMachine
from .instructions import FUNCTIONS, IGNORED, spline
from .parser import KrlParser, is_data


class KrlTask(ProgramTask):
    """A task of a KRL program: declarations of several, spline blocks, and data that belongs to a file."""

    def statement(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Carry out a statement."""
        if node.kind == "declarations":
            yield from self.run(node.bodies[0], scope)
        elif node.kind == "spline":
            yield from spline(self, node, scope)
        elif node.kind == "signal":
            yield from _signal(self, node, scope)
        else:
            yield from super().statement(node, scope)


def _prepare(machine: Machine, task: ProgramTask) -> Steps:
    """Declare the routines of all files; data of a ``.dat`` file is of the ``.src`` beside, or of all."""
    homes: dict[str, dict[str, Variable]] = {}
    for unit in machine.units:
        unit.tree.value = {}
        name = unit.source.name.rpartition(".")[0].lower()
        is_global = name.startswith("$")
        unit.names = machine.globals if is_global else homes.setdefault(name, {})
        for node in unit.tree.bodies[0]:
            if node.kind == "routine":
                unit.tree.value[node.name] = Routine(node, unit)
                machine.routines.setdefault(node.name, Routine(node, unit))
    waiting = [(node, RoutineScope(unit, "<module>")) for unit in machine.units for node in _data(unit)]
    yield from declare_data(task, waiting, lambda node, scope: _declare(task, node, scope))


def _data(unit: ProgramUnit) -> list[ProgramNode]:
    """Return the declarations of a data file, and those at the top of another file."""
    found: list[ProgramNode] = []
    for node in unit.tree.bodies[0]:
        members = node.bodies[0] if is_data(node) else [node]
        for part in members:
            found += part.bodies[0] if part.kind == "declarations" else [part]
    return [node for node in found if node.kind in ("declare", "assign", "signal", "opaque")]


def _declare(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    if node.kind == "declare":
        yield from task.dialect.declare(task, node, scope, is_global=True)
        if node.name in ("base_data", "tool_data"):
            task.machine.globals[node.name] = scope.unit.names[node.name]
    elif node.kind == "assign":
        yield from _element(task, node, scope)
    else:
        yield from task.statement(node, scope)


def _element(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out ``BASE_DATA[1]={…}`` of a data file; arrays without a declared size grow."""
    target, value = node.parts
    name = target.parts[0].name if target.kind == "index" and target.parts else ""
    found = task.find(name, scope) if name else None
    if found is not None and isinstance(found.value, str):
        found.value = yield from task.value(value, scope)
        return
    if found is not None and isinstance(found.value, list) and len(target.parts) == 2:
        index = int((yield from task.value(target.parts[1], scope)))
        found.value.extend({} for _ in range(index - len(found.value)))
        found.value[index - 1] = yield from task.value(value, scope)
        return
    yield from task.statement(node, scope)


def _signal(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    machine: Any = task.machine
    first = node.parts[0]
    if first.kind == "index":
        number = int((yield from task.value(first.parts[1], scope)))
        machine.signals[node.name] = f"{first.parts[0].name}[{number}]"
    else:
        machine.signals[node.name] = first.name


def _main(machine: Machine, task: ProgramTask, routine: str) -> Steps:
    """Carry out the routine with the name of the first file, or its first one."""
    first = machine.units[0]
    own = [node for node in first.tree.bodies[0] if node.kind == "routine" and not routine]
    yield from call_main(task, routine.lower() or first.source.name.rpartition(".")[0].lower(), own)


def _beside(file: Path) -> list[Path]:
    """Return the data file of a program, and ``$config.dat`` in its folder or in R1/System above it."""
    found = [
        path
        for path in sorted(file.parent.iterdir())
        if path.suffix.lower() == ".dat" and path.stem.lower() in (file.stem.lower(), "$config")
    ]
    return [path for path in found if path != file]


KRL = RobotLanguage(
    "krl",
    (".src", ".dat", ".sub"),
    KrlParser,
    lambda: KrlDialect(FUNCTIONS, IGNORED),
    _prepare,
    _main,
    machine=KrlMachine,
    task=KrlTask,
    beside=_beside,
)
