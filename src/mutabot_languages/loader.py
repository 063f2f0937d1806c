"""Load a robot program from its files and run it on a cell."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

from .core.language import MODULE, RobotLanguage
from .core.machine import Machine
from .core.schedule import TaskSchedule
from .core.scope import ProgramUnit, Steps
from .core.signals import CellMap
from .core.station import Station
from .core.text import decode
from .core.tree import ProgramNode, routines
from .edits import ActiveEdits, active, applied, note_read
from .errors import LanguageError
from .registry import LANGUAGES, language_for

_MAIN = "main"
#: pytest shows the test and what stopped the program, and no function of this package between them
for _module in [module for name, module in sys.modules.items() if name.startswith(f"{__package__}.")]:
    _module.__dict__["__tracebackhide__"] = True


@dataclass(frozen=True, slots=True)
class ProgramRun:
    """What became of a run.

    Attributes:
        variables: the program's global variables at its end, by name.
        outputs: the last value of each output, by name.
        notes: what had no effect in the cell, each once.
        seconds: simulated time that it took.
    """

    variables: Mapping[str, Any]
    outputs: Mapping[str, Any]
    notes: tuple[str, ...]
    seconds: float


@dataclass(frozen=True, slots=True)
class RobotProgram:
    """A robot program.

    Attributes:
        files: its files, the one with the main routine first.
        language: what they are written in.
        cell_map: what its signals are in the cell.
    """

    files: tuple[Path, ...]
    language: RobotLanguage
    cell_map: CellMap = field(default_factory=CellMap)

    def run(
        self,
        cell: Any,
        routine: str = "",
        *,
        inputs: Mapping[str, Any] | None = None,
        until: Callable[[], bool] | None = None,
        limit: float = 600.0,
        seed: int = 0,
        tasks: Sequence[RobotProgram] = (),
    ) -> ProgramRun:
        """Run it from the beginning to its end.

        Args:
            cell: a ``mutabot_cell.Cell``.
            routine: to start with, instead of the program's own beginning.
            inputs: values of inputs by name, or functions that give them; they go before the cell map.
            until: ends the run, between two statements, as soon as it holds: for programs without an end.
            limit: simulated seconds, s, after which it is an error that the program still runs.
            seed: of the order in which tasks take turns.
            tasks: programs of the other tasks of a RAPID controller. They take turns with this one, share its
                signals and the PERS data that both declare, and end with it.

        Raises:
            LanguageError: a file cannot be read.
            ProgramError: the program stops with an error, such as a division by zero.
            UnsupportedError: it uses something that is not carried out.
            mutabot_cell.CellError: the cell stops it, by a motion that it refuses or by a protective stop.
        """
        share = self.language.share
        if tasks and (share is None or any(program.language is not self.language for program in tasks)):
            raise LanguageError("tasks: only programs in RAPID have others beside them, in RAPID as well")
        station = Station(cell, self.cell_map, inputs or {})
        machines = [program._machine(station, until, limit) for program in (self, *tasks)]
        machine, began, mains = machines[0], station.time, list[Steps]()
        schedule = TaskSchedule(machine, seed)
        for number, each in enumerate(machines):
            task = self.language.task(each, _MAIN)
            machine.start(_MAIN, self.language.prepare(each, task))
            schedule.run(_MAIN)
            mains.append(self.language.main(each, task, "" if number else routine))
            if number and share is not None:
                share(machine, each)
        for number, steps in enumerate(mains):
            machine.start(f"{_MAIN} {number}" if number else _MAIN, steps)
        schedule.run(_MAIN)
        names = {name: variable.value for name, variable in machine.globals.items()}
        for unit in machine.units:
            names |= {name: variable.value for name, variable in unit.names.items()}
        return ProgramRun(names, dict(station.outputs), tuple(station.notes), station.time - began)

    def _machine(self, station: Station, until: Callable[[], bool] | None, limit: float) -> Machine:
        units = [self._unit(file) for file in self.files]
        return self.language.machine(self.language.dialect(), station, units, until, limit)

    def _unit(self, file: Path) -> ProgramUnit:
        try:
            content = file.read_bytes()
        except OSError as error:
            raise LanguageError(f"{file}: the program cannot be read: {error.strerror}") from None
        text, _ = decode(content)
        note_read(file.resolve())
        found = [edits for edits in active() if edits.concern(file.resolve(), content)]
        assigned = _assigned(self.language.read(file.name, text).tree) if found else frozenset()
        text = applied(text, [edit for edits in found for edit in edits.edits])
        parsed = self.language.read(file.name, text)
        name = str(file.absolute())
        numbers = {routine.start: number for number, routine in enumerate(routines(parsed.tree), 1)}
        sys.audit("mutabot.executed", name, MODULE)
        unit = ProgramUnit(
            str(file.resolve()),
            parsed.source,
            parsed.tree,
            assigned=assigned,
            began=lambda start: sys.audit("mutabot.executed", name, numbers[start]),
        )
        unit.watched = {start: edits.reached for edits in found for start in _watched(parsed.tree, edits)}
        return unit


def load(
    path: str | PathLike[str], *more: str | PathLike[str], cell_map: str | PathLike[str] | None = None
) -> RobotProgram:
    """Return a program from its files.

    Args:
        path: the file with the main routine. Of KRL, the ``.dat`` beside a ``.src``, and ``$config.dat``,
            belong to it by themselves.
        more: other files of the program.
        cell_map: the TOML file that says what its signals are in the cell; ``cell_map.toml`` beside the
            program by default, if there is one.

    Raises LanguageError for a file that is not there or of no known language, and for a wrong cell map.
    """
    files = [Path(path), *map(Path, more)]
    languages = [language_for(program.name) for program in files]
    for file, language in zip(files, languages, strict=True):
        if language is None or language is not languages[0]:
            known = ", ".join(suffix for known_language in LANGUAGES for suffix in known_language.suffixes)
            raise LanguageError(
                f"{file}: the files of a program have one language, and end with one of {known}"
            )
        if not file.is_file():
            raise LanguageError(f"{file}: there is no such file")
    found = languages[0]
    assert found is not None
    for file in tuple(files):
        files += [addition for addition in found.beside(file) if addition not in files]
    beside = files[0].parent / "cell_map.toml"
    chosen = Path(cell_map) if cell_map is not None else beside if beside.is_file() else None
    return RobotProgram(tuple(files), found, CellMap.read(chosen) if chosen is not None else CellMap())


def _assigned(tree: ProgramNode) -> frozenset[str]:
    """Return the variables that a program gives a value."""
    targets = (node.parts[0] for node in tree.walk() if node.kind == "assign")
    return frozenset(target.name for target in targets if target.kind == "name")


def _watched(tree: ProgramNode, edits: ActiveEdits) -> list[int]:
    """Return where the statements begin that are different."""
    shift, found = 0, list[int]()
    for edit in sorted(edits.edits, key=lambda watched_edit: watched_edit.start):
        start, end = edit.start + shift, edit.start + shift + len(edit.text)
        inside = [
            node
            for parent in tree.walk()
            for body in parent.bodies
            for node in body
            if node.kind != "routine" and node.start <= start and node.end >= end
        ]
        if inside:
            found.append(min(inside, key=lambda node: (node.end - node.start, -node.start)).start)
        shift += len(edit.text) - (edit.end - edit.start)
    return found
