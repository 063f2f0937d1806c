"""RAPID as a language that mutabot knows."""

from __future__ import annotations

from mutabot_languages.core.language import RobotLanguage
from mutabot_languages.core.machine import Dialect, Machine
from mutabot_languages.core.scope import ProgramUnit, Routine, RoutineScope, Steps
from mutabot_languages.core.task import ProgramTask, call_main, declare_data
from mutabot_languages.core.tree import ProgramNode

from .dialect import RapidDialect, RapidTask
from .instructions import FUNCTIONS, IGNORED
from .parser import RapidParser


def _prepare(machine: Machine, task: ProgramTask) -> Steps:
    """Declare routines, structures and data of all modules, whatever their order."""
    waiting: list[tuple[ProgramNode, RoutineScope]] = []
    for unit in machine.units:
        unit.tree.value = {}
        scope = RoutineScope(unit, "<module>")
        for node in _members(unit):
            if node.kind == "routine":
                home = unit.tree.value if node.value["scope"] == "local" else machine.routines
                home[node.name] = Routine(node, unit)
            elif node.kind == "record":
                _structure(machine.dialect, node)
            elif node.kind == "declare":
                waiting.append((node, scope))
            elif node.kind == "opaque":
                yield from task.statement(node, scope)
    yield from declare_data(
        task, waiting, lambda node, scope: task.dialect.declare(task, node, scope, is_global=True)
    )


def _members(unit: ProgramUnit) -> list[ProgramNode]:
    found: list[ProgramNode] = []
    for node in unit.tree.bodies[0]:
        found += node.bodies[0] if node.kind == "module" else [node]
    return found


def _structure(dialect: Dialect, node: ProgramNode) -> None:
    assert isinstance(dialect, RapidDialect)
    if isinstance(node.value, str):
        dialect.aliases[node.name] = dialect.aliases.get(node.value, node.value)
    else:
        dialect.structures[node.name] = tuple(node.value)


def _main(machine: Machine, task: ProgramTask, routine: str) -> Steps:
    """Carry out the routine ``main``, or the first of the first file that takes no arguments."""
    members = _members(machine.units[0])
    own = [member for member in members if member.kind == "routine" and member.value["kind"] == "proc"]
    own.sort(key=lambda node: bool(node.parts))
    yield from call_main(task, routine.lower() or "main", [] if routine else own)


def _share(first: Machine, other: Machine) -> None:
    """Share between tasks the PERS data that both declare, and their interrupts."""
    other.tasks, other.interrupts = first.tasks, first.interrupts
    for node in (member for unit in other.units for member in _members(unit) if member.kind == "declare"):
        is_shared = (node.value["kind"], node.value["scope"]) == ("pers", "")
        if is_shared and node.name in first.globals:
            other.globals[node.name] = first.globals[node.name]


RAPID = RobotLanguage(
    "rapid",
    (".mod", ".sys", ".prg", ".modx", ".sysx"),
    RapidParser,
    lambda: RapidDialect(FUNCTIONS, IGNORED),
    _prepare,
    _main,
    task=RapidTask,
    share=_share,
)
