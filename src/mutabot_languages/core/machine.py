"""The machine: it works out the expressions of any language, in simulated time.

A task yields a ``TaskOperation`` whenever time has to pass: a motion or a wait. Which task goes on when is
decided by ``schedule.TaskSchedule``. What a name means says the ``Dialect``.
"""

from __future__ import annotations

import copy
import operator
from collections.abc import Callable, Generator, Mapping, Sequence
from typing import Any, ClassVar

from mutabot_languages.errors import LanguageError, ProgramError, UnsupportedError

from .interrupts import Interrupts
from .scope import ControlFlow, ProgramUnit, Routine, RoutineScope, Steps, TaskOperation, Variable
from .station import TICK, ArmMotion, ProgramPlace, Station
from .tree import ProgramNode, in_short

#: statements that a program may carry out in all
MOST_STEPS = 2_000_000
_DEEPEST_CALLS = 60
#: what operators that all languages have make of two numbers
OF_NUMBERS: Mapping[str, Callable[[Any, Any], Any]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv,
    "<": operator.lt, ">": operator.gt, "<=": operator.le, ">=": operator.ge,
}  # fmt: skip
#: what others make of two values of any kind
OF_VALUES: Mapping[str, Callable[[Any, Any], Any]] = {
    "==": operator.eq, "!=": operator.ne, "<>": operator.ne, "and": lambda left, right: bool(left and right),
    "or": lambda left, right: bool(left or right),
    **dict.fromkeys(("xor", "exor"), lambda left, right: bool(left) != bool(right)),
}  # fmt: skip


class Dialect:
    """What a language gives its names, operators and instructions.

    Class attributes:
        first: the number of the first element of an array.
        has_none: whether a variable may get what a routine without a value returns.
        constants: values by name.

    Args:
        functions: what a name that is called means: it gets the task, the node and the scope, and returns a
            value or a generator of operations that does.
        ignored: what is accepted without an effect, and noted.
    """

    first: ClassVar[int] = 0
    has_none: ClassVar[bool] = False
    constants: ClassVar[Mapping[str, Any]] = {}

    def __init__(self, functions: Mapping[str, Callable[..., Any]], ignored: frozenset[str]) -> None:
        self.functions, self.ignored = functions, ignored

    def declare(self, task: Evaluation, node: ProgramNode, scope: RoutineScope, *, is_global: bool) -> Steps:
        """Make the variable of a declaration."""
        raise NotImplementedError

    def name(self, task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Any:
        """Return the value of a name that is no variable. Raises UnsupportedError."""
        raise task.unsupported(node, scope)

    def index(self, task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Any:
        """Return the value of an index of a name that is no variable; NotImplemented for other names."""
        return NotImplemented

    def assign(self, task: Evaluation, target: ProgramNode, value: Any, scope: RoutineScope) -> Any:
        """Set something that is no variable; NotImplemented if it is none of these."""
        return NotImplemented

    def binary(self, operator: str, left: Any, right: Any) -> Any:
        """Return the value of a binary operation. Raises TypeError, ValueError, ZeroDivisionError."""
        raise NotImplementedError

    def unary(self, operator: str, value: Any) -> Any:
        """Return the value of a unary operation."""
        return -value if operator == "-" else value if operator == "+" else not self.truth(value)

    def literal(self, task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Return the value of a list, a pose or an aggregate."""
        raise NotImplementedError

    def truth(self, value: Any) -> bool:
        """Return whether a condition holds."""
        return bool(value)

    def assigned(self, variable: Variable, value: Any) -> Any:
        """Return what a variable of a type gets."""
        return copy.deepcopy(value) if isinstance(value, (list, dict)) else value

    def matches(self, subject: Any, label: Any) -> bool:
        """Return whether a case of a switch is meant."""
        return bool(subject == label)

    def is_reference(self, parameter: ProgramNode) -> bool:
        """Return whether a parameter is the caller's variable itself."""
        return False


class Machine:
    """A run of a program.

    Args:
        dialect: of its language.
        station: the cell.
        units: its files.
        until: ends the run where it holds, between two statements.
        limit: simulated seconds after which it is an error to be still running.
    """

    def __init__(
        self,
        dialect: Dialect,
        station: Station,
        units: list[ProgramUnit],
        until: Callable[[], bool] | None,
        limit: float,
    ) -> None:
        self.dialect, self.station, self.units = dialect, station, units
        self.globals: dict[str, Variable] = {}
        self.routines: dict[str, Routine] = {}
        self.tasks: dict[str, Steps] = {}
        self.running: dict[int, Routine] = {}
        self.interrupts = Interrupts()
        self.undeclared: dict[str, LanguageError | ProgramError] = {}
        self._until, self._end = until, station.time + limit
        self._limit = limit
        self._left = MOST_STEPS
        self._sites: dict[tuple[int, int], ProgramPlace] = {}

    def step(self, node: ProgramNode, scope: RoutineScope) -> None:
        """Count a statement. Raises ProgramError when there were too many, or it takes too long."""
        self._left -= 1
        source = scope.unit.source
        if self._left < 0:
            raise ProgramError(f"{source.name}: more than {MOST_STEPS} statements: it may never end")
        if self._until is not None and self._until():
            raise ControlFlow("exit")
        if self.station.time > self._end:
            raise ProgramError(
                f"{source.name}:{source.line_of(node.start)}: the program is not over after "
                f"{self._limit:g} s: let it end, or give run() an end: until=…, or limit=…"
            )

    def site(self, node: ProgramNode, scope: RoutineScope) -> ProgramPlace:
        """Return the part of the program that a node is."""
        key = (id(scope.unit), id(node))
        found = self._sites.get(key)
        if found is None:
            extent = scope.unit.source.extent(node.start, node.end)
            found = self._sites[key] = ProgramPlace(
                scope.unit.path, extent, scope.routine, in_short(node, scope.unit.source.text)
            )
        return found

    def start(self, name: str, steps: Steps) -> None:
        """Start a task."""
        self.tasks[name] = steps


class Evaluation:
    """The values of expressions, for one thread of a program.

    Args:
        machine: the run it belongs to.
        name: of the task.
    """

    def __init__(self, machine: Machine, name: str) -> None:
        self.machine, self.dialect, self.station = machine, machine.dialect, machine.station
        self.name = name
        self.depth = 0
        self.idle_loops = 0

    def run(self, body: list[ProgramNode], scope: RoutineScope) -> Steps:
        """Carry out statements."""
        raise NotImplementedError

    def store(self, target: ProgramNode, value: Any, scope: RoutineScope, how: str = "") -> Steps:
        """Give a variable, a component or an element a value."""
        raise NotImplementedError

    # errors and places

    def site(self, node: ProgramNode, scope: RoutineScope) -> ProgramPlace:
        """Return the part of the program that a node is."""
        return self.machine.site(node, scope)

    def place(self, node: ProgramNode, scope: RoutineScope) -> str:
        """Return where a node stands, for messages."""
        source = scope.unit.source
        return f"{source.name}:{source.line_of(node.start)}"

    def unsupported(self, node: ProgramNode, scope: RoutineScope, what: str = "") -> UnsupportedError:
        """Return the error for something that is not carried out."""
        source = scope.unit.source
        why = ", which no loaded file declares" if not (what or node.name.startswith("$")) else ""
        line = source.line_of(node.start)
        return UnsupportedError(f"unsupported: {what or node.name} at line {line} of {source.name}{why}")

    def note_without_effect(self, node: ProgramNode, scope: RoutineScope) -> None:
        """Note that what a node calls has no effect here."""
        self.station.note(f"{node.name} at line {scope.unit.source.line_of(node.start)} has no effect here")

    def error(self, node: ProgramNode, scope: RoutineScope, text: str) -> ProgramError:
        """Return an error of the program at a node."""
        return ProgramError(f"{self.place(node, scope)}: {text} (in {scope.routine})")

    # values

    def value(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Return the value of an expression."""
        kind = node.kind
        if kind in ("number", "text", "constant"):
            return node.value
        if kind == "name":
            return self._name(node, scope)
        if kind == "group":
            return (yield from self.value(node.parts[0], scope))
        if kind == "call":
            return (yield from self._called(node, scope))
        if kind == "binary":
            return (yield from self._binary(node, scope))
        if kind == "unary":
            return self.dialect.unary(node.name, (yield from self.value(node.parts[0], scope)))
        if kind == "index":
            return (yield from self._index(node, scope))
        if kind == "field":
            owner = yield from self.value(node.parts[0], scope)
            if isinstance(owner, dict) and node.name in owner:
                return owner[node.name]
            raise self.error(node, scope, f"there is no component {node.name}")
        if kind in ("list", "pose", "aggregate", "enum", "method", "option"):
            return (yield from self.dialect.literal(self, node, scope))
        raise self.unsupported(node, scope, node.name or kind)

    def _called(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Return the value that a call has where one is needed."""
        found = yield from self.call(node, scope)
        if found is None and node.name in self.dialect.ignored:
            raise self.unsupported(node, scope, f"the value of {node.name}")
        if found is None:
            raise self.error(node, scope, f"{node.name} has no value: it returns none")
        return found

    def _name(self, node: ProgramNode, scope: RoutineScope) -> Any:
        found = self.find(node.name, scope)
        if found is not None:
            if found.value is None:
                text = f"{node.name} has no value: {scope.routine} was called without it, or nothing set it"
                raise self.error(node, scope, text)
            return found.value
        if node.name in self.machine.undeclared:
            why = self.machine.undeclared[node.name]
            raise type(why)(f"{self.place(node, scope)}: {node.name}: {why} (in {scope.routine})")
        if node.name in self.dialect.constants:
            return copy.deepcopy(self.dialect.constants[node.name])
        if node.name in scope.unit.assigned:
            raise self.error(node, scope, f"{node.name} has no value")
        return self.dialect.name(self, node, scope)

    def _binary(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        left = yield from self.value(node.parts[0], scope)
        if node.name == "and" and not self.dialect.truth(left):
            return False
        if node.name == "or" and self.dialect.truth(left):
            return True
        right = yield from self.value(node.parts[1], scope)
        try:
            return self.dialect.binary(node.name, left, right)
        except (TypeError, ValueError, ZeroDivisionError, OverflowError) as error:
            raise self.error(node, scope, f"{node.name} of {left!r} and {right!r}: {error}") from error

    def _index(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        base = node.parts[0]
        if base.kind == "name" and self.find(base.name, scope) is None:
            found = self.dialect.index(self, node, scope)
            if found is not NotImplemented:
                return (yield from found) if isinstance(found, Generator) else found
        owner = yield from self.value(base, scope)
        for part in node.parts[1:]:
            index = self.whole_number(part, (yield from self.value(part, scope)), scope)
            if not isinstance(owner, (list, str)) or not 0 <= index < len(owner):
                raise self.error(node, scope, f"there is no element {index + self.dialect.first}")
            owner = owner[index]
        return owner

    def whole_number(self, node: ProgramNode, value: Any, scope: RoutineScope) -> int:
        """Return the index of an element, from 0. Raises ProgramError if the value is none."""
        if isinstance(value, bool) or not isinstance(value, (int, float)) or value != int(value):
            raise self.error(node, scope, f"an index must be a whole number, not {value!r}")
        return int(value) - self.dialect.first

    def values(
        self, nodes: Sequence[ProgramNode], scope: RoutineScope
    ) -> Generator[TaskOperation, Any, list[Any]]:
        """Return the values of several expressions, in their order."""
        found = list[Any]()
        for node in nodes:
            found.append((yield from self.value(node, scope)))  # no comprehension can yield
        return found

    # names and calls

    def find(self, name: str, scope: RoutineScope, *, of_globals: bool = False) -> Variable | None:
        """Return a variable, from the inside out; None if there is none."""
        for inner in () if of_globals else scope.chain():
            if name in inner.names:
                return inner.names[name]
        return scope.unit.names.get(name) or self.machine.globals.get(name)

    def find_routine(self, name: str, scope: RoutineScope) -> Routine | None:
        """Return a routine, from the inside out; None if there is none."""
        for inner in scope.chain():
            if name in inner.routines:
                return inner.routines[name]
        own = scope.unit.tree.value or {}
        return own.get(name) or self.machine.routines.get(name)

    def call(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Call a function of the cell map, a routine of the program, or what the language brings."""
        entry = self.station.function(node.name)
        if entry is not None:
            return (yield from self._mapped(node, entry, scope))
        routine = self.find_routine(node.name, scope)
        if routine is not None:
            return (yield from self.call_routine(routine, node.parts, node, scope))
        function = self.dialect.functions.get(node.name)
        if function is not None:
            found = function(self, node, scope)
            return (yield from found) if isinstance(found, Generator) else found
        if node.name in self.dialect.ignored:
            self.note_without_effect(node, scope)
            return None
        raise self.unsupported(node, scope)

    def _mapped(self, node: ProgramNode, entry: Mapping[str, Any], scope: RoutineScope) -> Steps:
        self.station.drive(self.site(node, scope), entry, is_on=True)
        if entry.get("wait"):
            yield from self.wait(node, scope, float(entry["wait"]))
        return entry.get("result", True)

    def call_routine(
        self, routine: Routine, arguments: Sequence[ProgramNode], node: ProgramNode, scope: RoutineScope
    ) -> Steps:
        """Call a routine of the program; what it returns."""
        if self.depth >= _DEEPEST_CALLS:
            raise self.error(node, scope, f"more than {_DEEPEST_CALLS} calls inside each other")
        inner = RoutineScope(routine.unit, routine.node.name, self._outer(routine, scope))
        back = yield from self._bind(routine.node, arguments, node, scope, inner)
        self.depth += 1
        result = None
        try:
            yield from self.body(routine, inner)
        except ControlFlow as leave:
            if leave.kind != "return":
                raise
            result = leave.value
        else:
            if isinstance(routine.node.value, dict) and routine.node.value["type"]:
                raise self.error(node, scope, f"{routine.node.name} ended without RETURN, and has no value")
        finally:
            self.depth -= 1
        for target, name in back:
            yield from self.store(target, inner.names[name].value, scope)
        return result

    def body(self, routine: Routine, inner: RoutineScope) -> Steps:
        """Carry out the body of a routine."""
        routine.unit.began(routine.node.start)
        yield from self.run(routine.node.bodies[0], inner)

    def _outer(self, routine: Routine, scope: RoutineScope) -> RoutineScope | None:
        found = (inner for inner in scope.chain() if inner.routines.get(routine.node.name) is routine)
        return next(found, None)

    def _bind(
        self,
        routine: ProgramNode,
        arguments: Sequence[ProgramNode],
        node: ProgramNode,
        scope: RoutineScope,
        inner: RoutineScope,
    ) -> Generator[TaskOperation, Any, list[tuple[ProgramNode, str]]]:
        """Give parameters their arguments; returns what is to be stored back afterwards."""
        back: list[tuple[ProgramNode, str]] = []
        named = {argument.name: argument for argument in arguments if argument.kind == "option"}
        unnamed = [argument for argument in arguments if argument.kind != "option"]
        for parameter in routine.parts:
            given: ProgramNode | None = None
            if parameter.name in named:
                option = named.pop(parameter.name)
                given = option.parts[0] if option.parts else None
                inner.given.add(parameter.name)
            elif not (isinstance(parameter.value, dict) and parameter.value.get("optional")):
                given = unnamed.pop(0) if unnamed else None
                if given is not None:
                    inner.given.add(parameter.name)
            type = parameter.value.get("type", "") if isinstance(parameter.value, dict) else ""
            if given is None or given.kind == "omitted":
                value = (yield from self.value(parameter.parts[0], scope)) if parameter.parts else None
                inner.names[parameter.name] = Variable(value, type)
                continue
            variable = self.find(given.name, scope) if given.kind == "name" else None
            if self.dialect.is_reference(parameter) and variable is not None:
                inner.names[parameter.name] = variable
                continue
            value = yield from self.value(given, scope)
            made = inner.names[parameter.name] = Variable(None, type)
            made.value = self.dialect.assigned(made, value)
            if self.dialect.is_reference(parameter) and given.kind in ("index", "field"):
                back.append((given, parameter.name))
        if named or unnamed:
            extra = next(iter(named), "") or f"argument {len(routine.parts) + 1}"
            raise self.error(node, scope, f"{routine.name} takes no {extra}")
        return back

    # operations

    def wait(self, node: ProgramNode, scope: RoutineScope, seconds: float) -> Steps:
        """Let time pass."""
        if seconds > 0:
            yield TaskOperation("wait", self.site(node, scope), seconds=float(seconds))

    def move(
        self,
        node: ProgramNode,
        scope: RoutineScope,
        motion: ArmMotion,
        watch: Callable[[], None] | None = None,
    ) -> Steps:
        """Carry out a motion; ``watch`` is called in each of its ticks."""
        yield TaskOperation("move", self.site(node, scope), motion=motion, watch=watch)

    def until(
        self, node: ProgramNode, scope: RoutineScope, holds: Callable[[], Steps], seconds: float = 0.0
    ) -> Steps:
        """Wait until a condition holds; returns whether it does, or the seconds (if any) are over."""
        began = self.station.time
        while not self.dialect.truth((yield from holds())):
            if seconds and self.station.time - began >= seconds - TICK / 2:
                return False
            self.machine.step(node, scope)
            yield from self.wait(node, scope, TICK)
        return True

    def arguments(
        self, node: ProgramNode, scope: RoutineScope
    ) -> Generator[TaskOperation, Any, tuple[list[Any], dict[str, Any]]]:
        """Return the values of a call's arguments: those in order, and those by name."""
        values, named = list[Any](), dict[str, Any]()
        for part in node.parts:
            if part.kind == "option":
                named[part.name] = (yield from self.value(part.parts[0], scope)) if part.parts else True
            elif part.kind == "omitted":
                values.append(None)
            else:
                values.append((yield from self.value(part, scope)))
        return values, named
