"""What RAPID's names mean: its data, operators and error handlers."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from mutabot_languages.core.machine import OF_NUMBERS, OF_VALUES, Dialect, Evaluation
from mutabot_languages.core.scope import (
    ControlFlow,
    ProgramRaised,
    Routine,
    RoutineScope,
    Steps,
    Structure,
    Variable,
)
from mutabot_languages.core.task import ProgramTask
from mutabot_languages.core.tree import ProgramNode
from mutabot_languages.errors import ProgramError

from .types import STRUCTURES, Components, RapidArray, initial, shaped

_SPEED, _ZONE = re.compile(r"v(\d+)"), re.compile(r"z(\d+)")
_POSE0 = [[0, 0, 0], [1, 0, 0, 0]]


class RapidDialect(Dialect):
    """The dialect of RAPID."""

    first: ClassVar = 1

    def __init__(self, functions: Mapping[str, Callable[..., Any]], ignored: frozenset[str]) -> None:
        super().__init__(functions, ignored)
        self.structures: dict[str, Components] = dict(STRUCTURES)
        self.aliases: dict[str, str] = {}

    def declare(self, task: Evaluation, node: ProgramNode, scope: RoutineScope, *, is_global: bool) -> Steps:
        """Make the data of a declaration."""
        type = self.aliases.get(node.value["type"], node.value["type"])
        sizes = []
        for size in node.value["sizes"]:
            found = yield from task.value(size, scope)
            sizes.append(int(found))
        if node.parts:
            value = shaped((yield from task.value(node.parts[0], scope)), type, self.structures)
        else:
            value = initial(type, self.structures, sizes)
        names = scope.names if not is_global else self._home(node, task, scope)
        names[node.name] = Variable(value, type)

    def _home(self, node: ProgramNode, task: Evaluation, scope: RoutineScope) -> dict[str, Variable]:
        return scope.unit.names if node.value["scope"] == "local" else task.machine.globals

    def name(self, task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Any:
        """Return the value of a signal, or of data that every program has."""
        found = predefined(node.name, self.structures)
        if found is not None:
            return found
        station = task.station
        if node.name in station.outputs and not station.knows_input(node.name):
            return station.outputs[node.name]
        return station.read(task.site(node, scope), node.name)

    def binary(self, operator: str, left: Any, right: Any) -> Any:
        """Return the value of a binary operation."""
        if operator in ("=", "<>"):
            return _equal(left, right) == (operator == "=")
        if operator in OF_VALUES:
            return OF_VALUES[operator](left, right)
        if isinstance(left, str) and isinstance(right, str) and operator == "+":
            return left + right
        left, right = _positions(left), _positions(right)
        if isinstance(left, Structure) or isinstance(right, Structure):
            return _of_positions(operator, left, right)
        return _of_numbers(operator, left, right)

    def literal(self, task: Evaluation, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Return the value of an aggregate, which gets its type where it is stored."""
        if node.kind != "list":
            raise task.unsupported(node, scope, node.name or node.kind)
        values = yield from task.values(node.parts, scope)
        return values

    def assigned(self, variable: Variable, value: Any) -> Any:
        """Return what data of a type gets."""
        type = variable.type or getattr(variable.value, "type", "")
        return shaped(value, type, self.structures)

    def matches(self, subject: Any, label: Any) -> bool:
        """Return whether a case of TEST is meant."""
        return _equal(subject, label)

    def is_reference(self, parameter: ProgramNode) -> bool:
        """Return whether a parameter is the caller's own data: INOUT, VAR or PERS."""
        return bool(parameter.value["mode"])


class RapidTask(ProgramTask):
    """A task of a RAPID program, with the error handlers of its routines."""

    def statement(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Carry out a statement; an error goes to the handler of its routine."""
        if scope.retry and (node.bodies or node.kind in ("raise", "retry", "trynext")):
            yield from self._plain(node, scope)
            return
        for _ in range(_RETRIES):
            try:
                yield from self._plain(node, scope)
            except ProgramRaised as error:
                if error.handled is scope:
                    raise
                handler = self._handler(scope)
                if handler is None:
                    raise ProgramError(f"{self.place(node, scope)}: {error} (in {scope.routine})") from error
                if not (yield from self._handle(handler, error, scope)):
                    return
            else:
                return
        raise self.error(node, scope, f"tried {_RETRIES} times again")

    def _plain(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        if node.kind in ("raise", "retry", "trynext"):
            if node.kind == "raise":
                number = (yield from self.value(node.parts[0], scope)) if node.parts else None
                number = number if number is not None else getattr(self, "errno", "an error")
                raise ProgramRaised(number, f"the program raises {number}")
            raise ControlFlow(node.kind)
        yield from super().statement(node, scope)

    def _handler(self, scope: RoutineScope) -> list[ProgramNode] | None:
        routine = self.machine.running.get(id(scope))
        if routine is None or scope.retry:
            return None
        sections = routine.node.value["sections"]
        return routine.node.bodies[1 + sections.index("error")] if "error" in sections else None

    def _handle(self, handler: list[ProgramNode], error: ProgramRaised, scope: RoutineScope) -> Steps:
        """Carry out a handler; returns whether the statement is to be tried again."""
        self.errno = error.number
        self.machine.globals["errno"] = Variable(error.number, "errnum")
        scope.retry += 1
        try:
            yield from self.run(handler, scope)
        except ProgramRaised as raised:
            raised.handled = scope
            raise
        except ControlFlow as leave:
            if leave.kind not in ("retry", "trynext"):
                raise
            return leave.kind == "retry"
        finally:
            scope.retry -= 1
        raise ProgramError(
            f"the error handler of {scope.routine} ends without RETRY, TRYNEXT or RETURN: {error}"
        )

    def body(self, routine: Routine, inner: RoutineScope) -> Steps:
        """Carry out the body of a routine, and know which one it is."""
        self.machine.running[id(inner)] = routine
        try:
            yield from super().body(routine, inner)
        finally:
            del self.machine.running[id(inner)]

    def value(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Return the value of an expression; an argument that is left out has none."""
        return None if node.kind == "omitted" else (yield from super().value(node, scope))


_RETRIES = 50


def predefined(name: str, structures: Mapping[str, Components]) -> Any:
    """Return data that every RAPID program has; None if there is none of this name."""
    speed, zone = _SPEED.fullmatch(name), _ZONE.fullmatch(name)
    if speed is not None:
        return shaped([int(speed[1]), 500, 5000, 1000], "speeddata", structures)
    if name == "vmax":
        return shaped([5000, 500, 5000, 1000], "speeddata", structures)
    if zone is not None:
        size = int(zone[1])
        return shaped(
            [False, size, size * 1.5, size * 1.5, size * 0.15, size * 1.5, 1], "zonedata", structures
        )
    if name in _DATA:
        type, value = _DATA[name]
        return shaped(value, type, structures) if type else value
    return name if name.startswith("err_") else None  # an error number


_DATA: dict[str, tuple[str, Any]] = {
    "fine": ("zonedata", [True, 0, 0, 0, 0, 0, 0]),
    "tool0": ("tooldata", [True, _POSE0, [0.001, [0, 0, 0.001], [1, 0, 0, 0], 0, 0, 0]]),
    "wobj0": ("wobjdata", [False, True, "", _POSE0, _POSE0]),
    "load0": ("loaddata", [0.001, [0, 0, 0.001], [1, 0, 0, 0], 0, 0, 0]),
    "pi": ("", math.pi), "high": ("", 1), "low": ("", 0), "edge": ("", 2), "on": ("", 1), "off": ("", 0),
    "stempty": ("", ""), "disp_no_rot": ("", 0), "true": ("", True), "false": ("", False),
    "end_of_list": ("", 0), "opgt": ("", 1), "oplt": ("", 2), "opeq": ("", 0),
}  # fmt: skip


def _equal(left: Any, right: Any) -> bool:
    if isinstance(left, Structure) and isinstance(right, list):
        return [*left.values()] == right
    if isinstance(left, (int, float)) and isinstance(right, (int, float)):
        return float(left) == float(right)
    return bool(left == right)


def _positions(value: Any) -> Any:
    if isinstance(value, list) and len(value) == 3 and not isinstance(value, RapidArray):
        return Structure.of("pos", dict(zip("xyz", value, strict=True)))
    return value


def _of_positions(operator: str, left: Any, right: Any) -> Any:
    if isinstance(left, Structure) and isinstance(right, Structure):
        pairs = zip(left.items(), right.values(), strict=True)
        if operator in "+-":
            sign = 1 if operator == "+" else -1
            return Structure.of("pos", {name: first + sign * second for (name, first), second in pairs})
        a, b = list(left.values()), list(right.values())
        if operator == "*" and len(a) == 3:
            cross = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
            return Structure.of("pos", dict(zip("xyz", cross, strict=True)))
        raise TypeError("not for these structures")
    record, number = (left, right) if isinstance(left, Structure) else (right, left)
    if operator not in "*/":
        raise TypeError("not for a structure and a number")
    return Structure.of("pos", {name: _of_numbers(operator, value, number) for name, value in record.items()})


def _of_numbers(operator: str, left: Any, right: Any) -> Any:
    if not all(isinstance(operand, (int, float)) for operand in (left, right)):
        raise TypeError("only numbers can be calculated with")
    if right == 0 and operator in ("/", "div", "mod"):
        raise ProgramRaised("err_divzero", "a division by zero")
    if operator == "div":
        return int(left / right)
    if operator == "mod":
        return int(math.fmod(left, right))
    return OF_NUMBERS[operator](left, right)
