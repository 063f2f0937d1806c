"""What a run of a program consists of: files, routines and their variables, and what a task waits for."""

from __future__ import annotations

import copy
from collections.abc import Callable, Generator, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from .station import ArmMotion, ProgramPlace
from .text import SourceText
from .tree import ProgramNode


@dataclass(frozen=True, slots=True)
class TaskOperation:
    """What a task waits for.

    Attributes:
        kind: ``move`` or ``wait``.
        site: the part of the program.
        motion: of a motion.
        seconds: of a wait.
        watch: of a motion: called in each of its ticks.
    """

    kind: str
    site: ProgramPlace
    motion: ArmMotion | None = None
    seconds: float = 0.0
    watch: Callable[[], None] | None = None


Steps = Generator[TaskOperation, Any, Any]


class Variable:
    """A place for a value."""

    __slots__ = ("type", "value")

    def __init__(self, value: Any = None, type: str = "") -> None:
        self.value, self.type = value, type


class Structure(dict[str, Any]):
    """A structure: its components by name, in the order of its type."""

    type = ""

    @classmethod
    def of(cls, type: str, components: Mapping[str, Any]) -> Structure:
        """Return a structure of a type."""
        made = cls(components)
        made.type = type
        return made

    def __deepcopy__(self, memo: dict[int, Any]) -> Structure:
        return Structure.of(self.type, {name: copy.deepcopy(value, memo) for name, value in self.items()})


@dataclass(slots=True)
class ProgramUnit:
    """A file that is being run.

    Attributes:
        path: where it stands, as front ends say it.
        source: its text.
        tree: what stands in it.
        names: its own variables.
        watched: nodes, by their starts, whose execution is reported.
        assigned: of a mutant, the variables that the original gives a value somewhere.
        began: called with the place at which a called routine begins.
    """

    path: str
    source: SourceText
    tree: ProgramNode
    names: dict[str, Variable] = field(default_factory=dict)
    watched: Mapping[int, Callable[[], None]] = field(default_factory=dict)
    assigned: frozenset[str] = frozenset()
    began: Callable[[int], None] = lambda start: None


@dataclass(slots=True)
class Routine:
    """A routine and the file it stands in."""

    node: ProgramNode
    unit: ProgramUnit


class RoutineScope:
    """What a running routine knows.

    Attributes:
        unit: the file it stands in.
        routine: its name, as sites have it.
        names: its variables.
        outer: of the routine around it, if it stands in one.
        given: names of its optional parameters that got an argument.
    """

    __slots__ = ("given", "names", "outer", "retry", "routine", "routines", "unit")

    def __init__(self, unit: ProgramUnit, routine: str, outer: RoutineScope | None = None) -> None:
        self.unit, self.routine, self.outer = unit, routine, outer
        self.names: dict[str, Variable] = {}
        self.given: set[str] = set()
        self.routines: dict[str, Routine] = {}
        self.retry = 0

    def chain(self) -> Iterator[RoutineScope]:
        """Yield this scope and those around it."""
        yield self
        if self.outer is not None:
            yield from self.outer.chain()


class ControlFlow(Exception):  # noqa: N818  (never leaves the machine)
    """Ends a loop, a routine or the program."""

    def __init__(self, kind: str, value: Any = None) -> None:
        super().__init__(kind)
        self.kind, self.value = kind, value


class ProgramRaised(Exception):  # noqa: N818  (as above)
    """An error that the program raises itself, by its number."""

    def __init__(self, number: Any, text: str) -> None:
        super().__init__(text)
        self.number = number
        self.handled: RoutineScope | None = None  # whose handler has raised it, for the caller
