"""The two controls that run in every campaign: one that must survive, one that must die."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from random import Random
from typing import ClassVar

from mutabot.families import CONTROL
from mutabot.model import Call, Middleware, Operation, Pattern, Proceed, Reply
from mutabot.model.values.quantity import Value

from .operator import Example, Operator, Subject

_HOME = Operation("robot:Arm.home")


class FatalFault(BaseException):
    """Raised by the fatal control. Not an ``Exception``, so that no program handles it by mistake."""


class Identity(Operator):
    """Goes through all the machinery and changes nothing."""

    name = "identity"
    family = CONTROL
    summary = "Control: proceeds unchanged, so it must survive."
    examples: ClassVar[tuple[Example, ...]] = (Example(Subject(_HOME), away="that is its purpose"),)

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        return [Subject(operation, pattern)]

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        async def mutated(call: Call, proceed: Proceed) -> Reply:
            return await proceed(call)

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return "unchanged"


class Fatal(Operator):
    """Raises instead of proceeding."""

    name = "fatal"
    does_nothing = True
    family = CONTROL
    summary = "Control: the operation raises, so it must die."
    examples: ClassVar[tuple[Example, ...]] = (Example(Subject(_HOME), raises=FatalFault),)

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        return [Subject(operation, pattern)]

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        async def mutated(call: Call, proceed: Proceed) -> Reply:
            raise FatalFault(f"control: {call.operation.name} fails")

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return "fails"


#: both, by name; they make no mutants of their own
CONTROLS: Mapping[str, type[Operator]] = {kind.name: kind for kind in (Identity, Fatal)}
