"""The two controls that run in every campaign: one that must survive, one that must die."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from mutabot.families import CONTROL
from mutabot.model import Call, Operation, Proceed, Reply

from .command import CommandOperator
from .context import Context
from .operator import Example, Operator, Subject

_HOME = Operation("robot:Arm.home")


class FatalFault(BaseException):
    """Raised by the fatal control. Not an ``Exception``, so that no program handles it by mistake."""


class Identity(CommandOperator):
    """Goes through all the machinery and changes nothing."""

    name = "identity"
    family = CONTROL
    summary = "Control: proceeds unchanged, so it must survive."
    fault = "unchanged"
    examples: ClassVar[tuple[Example, ...]] = (Example(Subject(_HOME), away="that is its purpose"),)

    def fits(self, whole: Subject) -> bool:
        return True

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        return await proceed(call)


class Fatal(Identity):
    """Raises instead of proceeding."""

    name = "fatal"
    does_nothing = True
    summary = "Control: the operation raises, so it must die."
    fault = "fails"
    examples: ClassVar[tuple[Example, ...]] = (Example(Subject(_HOME), raises=FatalFault),)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        raise FatalFault(f"control: {call.operation.name} fails")


#: both, by name; they make no mutants of their own
CONTROLS: Mapping[str, type[Operator]] = {kind.name: kind for kind in (Identity, Fatal)}
