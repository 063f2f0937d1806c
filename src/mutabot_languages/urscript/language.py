"""URScript as a language that mutabot knows."""

from __future__ import annotations

from mutabot_languages.core.language import RobotLanguage
from mutabot_languages.core.machine import Machine
from mutabot_languages.core.scope import RoutineScope, Steps
from mutabot_languages.core.task import ProgramTask
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.errors import LanguageError

from .dialect import UrDialect
from .parser import URScriptParser


def _prepare(machine: Machine, task: ProgramTask) -> Steps:
    """Routines of all files are known; other statements at the top are the program itself."""
    for unit in machine.units:
        scope = RoutineScope(unit, "<module>")
        for node in unit.tree.bodies[0]:
            if node.kind == "routine":
                yield from task.statement(node, scope)
        machine.routines |= scope.routines


def _main(machine: Machine, task: ProgramTask, routine: str) -> Steps:
    """Statements at the top run as they stand; a file of definitions alone runs its last one."""
    if routine:
        if routine not in machine.routines:
            known = ", ".join(machine.routines) or "none"
            raise LanguageError(f"there is no function {routine!r}; there are: {known}")
        call = ProgramNode("call", routine, 0, 0)
        found = machine.routines[routine]
        yield from task.call_routine(found, [], call, RoutineScope(found.unit, "<module>"))
        return
    unit = machine.units[0]
    body = unit.tree.bodies[0]
    scope = RoutineScope(unit, "<module>")
    scope.names = machine.globals
    own = [one for one in body if one.kind == "routine"]
    calls = [one for one in body if one.kind == "call"]
    yield from task.run([one for one in body if one.kind != "routine"], scope)
    if own and not calls:
        last = machine.routines[own[-1].name]
        yield from task.call_routine(last, [], own[-1], scope)


URSCRIPT = RobotLanguage("urscript", (".script", ".urscript"), URScriptParser, UrDialect, _prepare, _main)
