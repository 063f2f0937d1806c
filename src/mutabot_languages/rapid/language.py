"""RAPID as a language that mutabot knows."""

from __future__ import annotations

from mutabot_languages.core.language import RobotLanguage
from mutabot_languages.core.machine import Dialect, Machine
from mutabot_languages.core.scope import ProgramUnit, Routine, RoutineScope, Steps
from mutabot_languages.core.task import ProgramTask
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.errors import LanguageError, ProgramError

from .dialect import RapidDialect, RapidMachine, RapidTask
from .instructions import FUNCTIONS, IGNORED
from .parser import RapidParser


def _prepare(machine: Machine, task: ProgramTask) -> Steps:
    """Routines, structures and data of all modules are known, whatever their order."""
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
    yield from _data(task, waiting)


def _data(task: ProgramTask, waiting: list[tuple[ProgramNode, RoutineScope]]) -> Steps:
    """Declare data until nothing is left; what names later data is declared after it."""
    while waiting:
        left: list[tuple[ProgramNode, RoutineScope]] = []
        for node, scope in waiting:
            try:
                _watch(node, scope)
                yield from task.dialect.declare(task, node, scope, is_global=True)
            except (TypeError, ValueError) as error:
                left.append((node, scope))
                task.machine.undeclared[node.name] = ProgramError(str(error))
            except (LanguageError, ProgramError) as error:
                left.append((node, scope))
                task.machine.undeclared[node.name] = error
            else:
                task.machine.undeclared.pop(node.name, None)
        if len(left) == len(waiting):  # what nobody uses is no error
            return
        waiting = left


def _watch(node: ProgramNode, scope: RoutineScope) -> None:
    if node.start in scope.unit.watched:
        scope.unit.watched[node.start]()


def _members(unit: ProgramUnit) -> list[ProgramNode]:
    found: list[ProgramNode] = []
    for node in unit.tree.bodies[0]:
        found += node.bodies[0] if node.kind == "module" else [node]
    return found


def _structure(dialect: Dialect, node: ProgramNode) -> None:
    assert isinstance(dialect, RapidDialect)
    if isinstance(node.value, str):
        dialect.aliases[node.name] = dialect.type_of(node.value)
    else:
        dialect.structures[node.name] = tuple(node.value)


def _main(machine: Machine, task: ProgramTask, routine: str) -> Steps:
    """The routine ``main``, or the first of the first file that takes no arguments."""
    first = machine.units[0]
    own = [one for one in _members(first) if one.kind == "routine" and one.value["kind"] == "proc"]
    name = routine.lower() or "main"
    scope = RoutineScope(first, "<module>")
    found = task.find_routine(name, scope)
    if found is None and not routine and own:
        found = Routine(next((one for one in own if not one.parts), own[0]), first)
    if found is None:
        known = ", ".join(machine.routines) or "none"
        raise LanguageError(f"{first.source.name}: there is no routine {name!r}; there are: {known}")
    yield from task.call_routine(found, [], found.node, scope)


RAPID = RobotLanguage(
    "rapid",
    (".mod", ".sys", ".prg", ".modx", ".sysx"),
    RapidParser,
    lambda: RapidDialect(FUNCTIONS, IGNORED),
    _prepare,
    _main,
    machine=RapidMachine,
    task=RapidTask,
)
