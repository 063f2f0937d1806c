"""The base of operators that act on a call as a whole, and the two controls of every campaign."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import replace
from random import Random
from typing import TYPE_CHECKING, Any, ClassVar

from mutabot.families import CONTROL
from mutabot.model import Call, Middleware, Operation, Proceed, Reply, Unchanged
from mutabot.model.activation import FatalFault
from mutabot.model.operation import Form

from .operator import Context, Example, Operator, Subject

if TYPE_CHECKING:
    from mutabot.model.quantity import Value

    from .magnitudes import Magnitudes

#: how descriptions call what goes its way under a form
_CALLED = {
    Form.PUBLISH: "message",
    Form.RECEIVE: "message",
    Form.CALL: "request",
    Form.GOAL: "goal",
    Form.FEEDBACK: "feedback",
    Form.RESULT: "result",
    Form.TICK: "tick",
    Form.SLEEP: "turn",
    Form.TRANSFORM: "transform",
    Form.PARAMETER: "parameter",
    Form.CANCEL: "cancellation",
}


class CommandOperator(Operator):
    """The base class of operators on whole calls: on commands, unless ``fits`` says otherwise.

    Class attributes:
        fault: description of the fault, with ``{what}`` for what is sent and ``{variant}`` for the variant.
        variants: a mutant each, with what they mean (``context.option``).
    """

    fault: ClassVar[str]
    variants: ClassVar[Mapping[str, Any]] = {"": None}

    @abstractmethod
    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        """Perform the mutated call. Raises Unchanged, before it proceeds, to leave the call alone."""

    def fits(self, whole: Subject) -> bool:
        """Return whether the operator can act on this call."""
        return whole.is_command

    def magnitudes(self, whole: Subject) -> Magnitudes | None:
        """Return the magnitudes of the fault, one for each mutant; None for a fault without sizes."""
        return None

    def subjects(self, whole: Subject) -> Iterator[Subject]:
        if self.fits(whole):
            ladder = self.magnitudes(whole)
            variants = (replace(whole, variant=variant) for variant in self.variants)
            yield from variants if ladder is None else ladder.of(whole)

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        context = Context(subject, random, self.variants.get(subject.variant))

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            context.number += 1
            try:
                return await self.mutated(call, proceed, context)
            except Unchanged as why:
                call = call.as_is(str(why))
            return await proceed(call)  # outside of the clause: what the robot raises has no such context

        return mutated

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return self.fault_text(subject)

    def fault_text(self, subject: Subject, **more: str) -> str:
        """Return ``fault`` with its placeholders filled in."""
        form = subject.operation.form
        what = _CALLED.get(form, "call") if form is not None else "call"
        return self.fault.format(what=what, variant=subject.variant, **more)


_HOME = Operation("robot:Arm.home")


class Identity(CommandOperator):
    """Control: proceeds unchanged, so its verdict must be *no effect*."""

    name = "identity"
    family = CONTROL
    fault = "unchanged"
    examples = (Example(Subject(_HOME), away="that is its purpose"),)

    def fits(self, whole: Subject) -> bool:
        return True

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        return await proceed(call)


class Fatal(Identity):
    """Control: the operation raises, so it must die."""

    name = "fatal"
    does_nothing = True
    fault = "fails"
    examples = (Example(Subject(_HOME), raises=FatalFault),)

    async def mutated(self, call: Call, proceed: Proceed, context: Context) -> Reply:
        raise FatalFault(f"control: {call.operation.name} fails")


#: both, by name; they make no mutants of their own
CONTROLS: Mapping[str, type[Operator]] = {kind.name: kind for kind in (Identity, Fatal)}
