"""What the operators of middlewares have in common: the forms that they act on."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Iterator
from typing import ClassVar

from mutabot.families import MIDDLEWARE
from mutabot.model import Operation, Pattern
from mutabot.model.named import Form
from mutabot.model.values.quantity import Value
from mutabot.operators.operator import Operator, Subject

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


class FormOperator(Operator):
    """Acts on whole calls of some forms.

    Class attributes:
        forms: the forms.
        variants: a mutant each.
    """

    family = MIDDLEWARE
    forms: ClassVar[frozenset[Form]] = frozenset()
    variants: ClassVar[tuple[str, ...]] = ("",)

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterable[Subject]:
        if form_of(operation) in self.forms:
            yield from (Subject(operation, pattern, variant=variant) for variant in self.variants)

    def describe(self, subject: Subject, before: Value | None, after: Value | None) -> str:
        return self.fault(subject, what(subject))

    @abstractmethod
    def fault(self, subject: Subject, what: str) -> str:
        """The fault in words; ``what`` is what is meant: the message, the request, the goal."""


def form_of(operation: Operation) -> Form | None:
    """What is done under its name; None for what has none."""
    return operation.named.form if operation.named is not None else None


def what(subject: Subject) -> str:
    """What goes its way in a call: a message, a request, a goal."""
    form = form_of(subject.operation)
    return _CALLED.get(form, "call") if form is not None else "call"


def seconds_in(subject: Subject, sizes: Iterable[float]) -> Iterator[Subject]:
    """The subject, once for each number of seconds."""
    for size in sizes:
        yield Subject(subject.operation, subject.pattern, subject.quantity, f"{size:g}", size)
