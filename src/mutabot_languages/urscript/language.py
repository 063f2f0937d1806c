"""URScript as a language that mutabot knows."""

from __future__ import annotations

from mutabot_languages.core.language import RobotLanguage
from mutabot_languages.core.machine import Machine
from mutabot_languages.core.scope import RoutineScope, Steps
from mutabot_languages.core.task import ProgramTask, call_main
from mutabot_languages.errors import LanguageError

from .dialect import UrDialect
from .parser import URScriptParser


def _prepare(machine: Machine, task: ProgramTask) -> Steps:
    """Declare the routines of all files; other statements at the top are the program itself."""
    for unit in machine.units:
        scope = RoutineScope(unit, "<module>")
        for node in unit.tree.bodies[0]:
            if node.kind == "routine":
                yield from task.statement(node, scope)
        machine.routines |= scope.routines


def _main(machine: Machine, task: ProgramTask, routine: str) -> Steps:
    """Carry out the statements at the top; a file of functions alone runs its last without arguments."""
    if routine:
        yield from call_main(task, routine, [])
        return
    unit = machine.units[0]
    body = unit.tree.bodies[0]
    scope = RoutineScope(unit, "<module>")
    scope.names = machine.globals
    own = [node for node in body if node.kind == "routine"]
    calls = [node for node in body if node.kind == "call"]
    yield from task.run([node for node in body if node.kind != "routine"], scope)
    if own and not calls:
        ends = [node for node in own if not node.parts]
        if ends:
            yield from call_main(task, ends[-1].name, [])
        elif len(own) == len(body):
            raise LanguageError(
                f"{unit.source.name}: nothing stands at its top, and each of its functions takes arguments: "
                "load the file that calls them, or add a call"
            )


URSCRIPT = RobotLanguage("urscript", (".script", ".urscript"), URScriptParser, UrDialect, _prepare, _main)
