"""A thread of a program: its statements, a generator of what it waits for."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from mutabot_languages.errors import LanguageError, ProgramError

from .machine import Evaluation
from .scope import ControlFlow, Routine, RoutineScope, Steps, Variable
from .station import TICK
from .tree import ProgramNode, in_short

_IDLE_LOOPS = 20
#: functions of angles in degrees
OF_DEGREES: dict[str, Callable[..., float]] = {
    "sin": lambda angle: math.sin(math.radians(angle)), "cos": lambda angle: math.cos(math.radians(angle)),
    "tan": lambda angle: math.tan(math.radians(angle)), "asin": lambda x: math.degrees(math.asin(x)),
    "acos": lambda x: math.degrees(math.acos(x)), "atan2": lambda y, x: math.degrees(math.atan2(y, x)),
}  # fmt: skip


class ProgramTask(Evaluation):
    """One thread of a program."""

    # statements

    def run(self, body: list[ProgramNode], scope: RoutineScope) -> Steps:
        """Carry out statements, with the jumps between them."""
        at = 0
        while at < len(body):
            try:
                yield from self.statement(body[at], scope)
            except ControlFlow as leave:
                if leave.kind != "goto":
                    raise
                found = [index for index, node in enumerate(body) if _is_label(node, leave.value)]
                if not found:
                    raise
                at = found[0]
                yield from self.pause(body[at], scope)
                continue
            at += 1

    def statement(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Carry out one statement."""
        self.machine.step(node, scope)
        if scope.unit.watched and node.start in scope.unit.watched:
            scope.unit.watched[node.start]()
        handler = _STATEMENTS.get(node.kind)
        try:
            if handler is not None:
                yield from handler(self, node, scope)
            else:
                yield from self.call(node, scope) if node.kind == "call" else self.value(node, scope)
        except (TypeError, ValueError, ZeroDivisionError, OverflowError) as error:
            if isinstance(error, self.station.errors):
                raise
            raise self.error(node, scope, f"{in_short(node, scope.unit.source.text)}: {error}") from error
        except (AttributeError, LookupError) as error:
            if isinstance(error, self.station.errors):
                raise
            # no operation of a program raises these: it is not known what a controller would do
            raise self.unsupported(node, scope, f"{node.kind} ({type(error).__name__}: {error})") from error

    def _assign(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        target, value = node.parts
        yield from self.store(target, (yield from self._result(value, scope)), scope, node.name)

    def _result(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Return the value of an expression that is assigned or returned."""
        may_be_none = node.kind == "call" and self.dialect.has_none
        return (yield from (self.call if may_be_none else self.value)(node, scope))

    def store(self, target: ProgramNode, value: Any, scope: RoutineScope, how: str = "") -> Steps:
        """Give a variable, a component or an element a value."""
        if target.kind == "group":
            target = target.parts[0]
        if target.kind == "name":
            special = self.dialect.assign(self, target, value, scope)
            if special is NotImplemented:
                self._variable_for(target, scope, how, value)
            elif special is not None:
                yield from special
            return
        if target.kind not in ("index", "field"):
            raise self.error(target, scope, "only a variable can get a value")
        special = self.dialect.assign(self, target, value, scope)
        if special is not NotImplemented:
            if special is not None:
                yield from special
            return
        owner = yield from self.value(target.parts[0], scope)
        if target.kind == "field":
            if not isinstance(owner, dict):
                raise self.error(target, scope, f"there is no component {target.name}")
            old = owner.get(target.name)
            owner[target.name] = self.dialect.assigned(Variable(old, getattr(old, "type", "")), value)
            return
        for part in target.parts[1:-1]:
            owner = owner[self.whole_number(part, (yield from self.value(part, scope)), scope)]
        index = self.whole_number(target.parts[-1], (yield from self.value(target.parts[-1], scope)), scope)
        if not isinstance(owner, list) or not 0 <= index < len(owner):
            raise self.error(target, scope, f"there is no element {index + self.dialect.first}")
        old = owner[index]
        owner[index] = self.dialect.assigned(Variable(old, getattr(old, "type", "")), value)

    def _variable_for(self, target: ProgramNode, scope: RoutineScope, how: str, value: Any) -> None:
        found = None if how == "local" else self.find(target.name, scope, of_globals=how == "global")
        if found is None:
            names = self.machine.globals if how == "global" else scope.names
            found = names[target.name] = Variable()
        found.value = self.dialect.assigned(found, value)

    def _if(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        for condition, body in zip(node.parts, node.bodies, strict=False):
            if self.dialect.truth((yield from self.value(condition, scope))):
                yield from self.run(body, scope)
                return
        if len(node.bodies) > len(node.parts):
            yield from self.run(node.bodies[-1], scope)

    def _loop(
        self, node: ProgramNode, scope: RoutineScope, before: ProgramNode | None, after: ProgramNode | None
    ) -> Steps:
        while True:
            if before is not None and not self.dialect.truth((yield from self.value(before, scope))):
                return
            if (yield from self.round(node, scope)):
                return
            if after is not None and self.dialect.truth((yield from self.value(after, scope))):
                return

    def round(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Carry out the body of a loop once; returns whether the loop is left."""
        began = self.station.time
        try:
            yield from self.run(node.bodies[0], scope)
        except ControlFlow as leave:
            if leave.kind == "break":
                return True
            if leave.kind != "continue":
                raise
        if self.station.time == began:
            yield from self.pause(node, scope)
        else:
            self.idle_loops = 0
        return False

    def pause(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        """Let a tick pass now and then in a loop that lets none pass itself."""
        self.machine.step(node, scope)
        self.idle_loops += 1
        if self.idle_loops >= _IDLE_LOOPS:
            self.idle_loops = 0
            yield from self.wait(node, scope, TICK)

    def _for(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        values = yield from self.values(node.parts, scope)
        start, end, step = values[0], values[1], values[2] if len(values) > 2 else None
        if step is None:
            step = node.value if node.value is not None else 1 if end >= start else -1
        if step == 0:
            raise self.error(node, scope, "a loop with the step 0")
        counter = self.find(node.name, scope) if self.dialect.first and node.value is not None else None
        own = counter is None
        if counter is None:
            counter = Variable()
            hidden = scope.names.get(node.name)
            scope.names[node.name] = counter
        counter.value = start
        while (counter.value <= end) if step > 0 else (counter.value >= end):
            if (yield from self.round(node, scope)):
                break
            counter.value += step
        if own:
            if hidden is not None:
                scope.names[node.name] = hidden
            elif node.value is None:
                del scope.names[node.name]

    def _switch(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        subject = yield from self.value(node.parts[0], scope)
        chosen = None
        for labels, body in zip(node.value, node.bodies, strict=True):
            if labels is None:
                chosen = body if chosen is None else chosen
                continue
            for label in labels:
                if self.dialect.matches(subject, (yield from self.value(label, scope))):
                    yield from self._case(body, scope)
                    return
        if chosen is not None:
            yield from self._case(chosen, scope)

    def _case(self, body: list[ProgramNode], scope: RoutineScope) -> Steps:
        try:
            yield from self.run(body, scope)
        except ControlFlow as leave:
            if leave.kind != "break" or self.dialect.first:  # a break of URScript ends the case
                raise

    def _return(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        raise ControlFlow("return", (yield from self._result(node.parts[0], scope)) if node.parts else None)

    def _leave(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        raise ControlFlow(node.kind, node.name)
        yield  # pragma: no cover  (makes it a generator)

    def _declare(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        yield from self.dialect.declare(self, node, scope, is_global=False)

    def _routine(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        scope.routines[node.name] = Routine(node, scope.unit)
        return
        yield  # pragma: no cover

    def _opaque(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        found = scope.unit.source.text[node.start : node.end].strip().splitlines()
        raise LanguageError(
            f"{self.place(node, scope)}: this could not be read: {found[0][:60] if found else ''} "
            f"(in {scope.routine})"
        )
        yield  # pragma: no cover

    def _nothing(self, node: ProgramNode, scope: RoutineScope) -> Steps:
        return
        yield  # pragma: no cover


def declare_data(
    task: ProgramTask,
    waiting: list[tuple[ProgramNode, RoutineScope]],
    declare: Callable[[ProgramNode, RoutineScope], Steps],
) -> Steps:
    """Declare data until nothing is left; what names later data is declared after it."""
    undeclared = task.machine.undeclared
    while waiting:
        left: list[tuple[ProgramNode, RoutineScope]] = []
        for node, scope in waiting:
            try:
                if node.start in scope.unit.watched:
                    scope.unit.watched[node.start]()
                yield from declare(node, scope)
            except (LanguageError, ProgramError) as error:
                left.append((node, scope))
                undeclared[_declared(node)] = error
            except (TypeError, ValueError) as error:
                left.append((node, scope))
                undeclared[_declared(node)] = ProgramError(str(error))
            else:
                undeclared.pop(_declared(node), None)
        if len(left) == len(waiting):  # what is not used is no error
            return
        waiting = left


def call_main(task: ProgramTask, name: str, own: list[ProgramNode]) -> Steps:
    """Call the routine with a name, else the first of these, which the first file has."""
    first = task.machine.units[0]
    scope = RoutineScope(first, "<module>")
    found = task.find_routine(name, scope) or (Routine(own[0], first) if own else None)
    if found is None:
        known = ", ".join(task.machine.routines) or "none"
        raise LanguageError(f"{first.source.name}: there is no routine {name!r}; there are: {known}")
    yield from task.call_routine(found, [], found.node, scope)


def _declared(node: ProgramNode) -> str:
    while node.kind in ("assign", "index", "field"):
        node = node.parts[0]
    return node.name


def _is_label(node: ProgramNode, name: Any) -> bool:
    return node.kind == "label" and node.name == name


_STATEMENTS: dict[str, Callable[[ProgramTask, ProgramNode, RoutineScope], Steps]] = {
    "assign": ProgramTask._assign,
    "if": ProgramTask._if,
    "while": lambda task, node, scope: task._loop(node, scope, node.parts[0], None),
    "repeat": lambda task, node, scope: task._loop(node, scope, None, node.parts[0]),
    "loop": lambda task, node, scope: task._loop(node, scope, None, None),
    "for": ProgramTask._for,
    "switch": ProgramTask._switch,
    "return": ProgramTask._return,
    "break": ProgramTask._leave,
    "continue": ProgramTask._leave,
    "goto": ProgramTask._leave,
    "exit": ProgramTask._leave,
    "declare": ProgramTask._declare,
    "routine": ProgramTask._routine,
    "record": ProgramTask._nothing,
    "empty": ProgramTask._nothing,
    "label": ProgramTask._nothing,
    "opaque": ProgramTask._opaque,
}


def pause(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out an instruction that waits for the seconds of its last argument."""
    values, _ = yield from task.arguments(node, scope)
    yield from task.wait(node, scope, float(values[-1]) if values else 0.0)


def end_program(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
    """Carry out an instruction that ends the program."""
    raise ControlFlow("exit")


def of_values(function: Callable[..., Any]) -> Callable[..., Steps]:
    """Return the meaning of a called name that is a function of values alone."""

    def call(task: ProgramTask, node: ProgramNode, scope: RoutineScope) -> Steps:
        values, named = yield from task.arguments(node, scope)
        try:
            return function(*values, **named)
        except (TypeError, ValueError, IndexError, ZeroDivisionError, OverflowError) as error:
            raise task.error(node, scope, f"{node.name}: {error}") from error

    return call
