"""From a subject to the variant that a mutant's id holds, and back."""

from __future__ import annotations

from dataclasses import replace

from mutabot.model import Operation, Pattern

from .operator import Operator, Subject


def with_operation(variant: str, target: str) -> str:
    """The variant that tells two operations of one site apart which have quantities of the same name."""
    return "+".join(part for part in (variant, target.partition(":")[2]) if part)


def subject_of(
    rule: Operator, operation: Operation, pattern: Pattern | None, quantity: str | None, variant: str
) -> Subject:
    """What the operator acts on in a mutant of this quantity and variant, as the operator itself says it.

    The variant may have become one ``with_operation``. Controls act where they are put.
    """
    for subject in rule.subjects(operation, pattern):
        name = subject.quantity.name if subject.quantity is not None else None
        if name == quantity and variant in (
            subject.variant,
            with_operation(subject.variant, operation.target),
        ):
            return subject
    whole = Subject(operation, pattern, None, variant)
    quantities = (*whole.written, *whole.read)
    return replace(whole, quantity=next((one for one in quantities if one.name == quantity), None))
