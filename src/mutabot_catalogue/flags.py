"""Operators on flags: interlocks that are bridged, switches that stick."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from mutabot.api.faults import Context, Example, Subject, ValueOperator
from mutabot.api.values import Kind, Operation, Quantity

from .values import CATALOGUE

_CURTAIN = Operation.reading("guards:is_clear", Kind.FLAG, values=(True, False))


class StuckFlag(ValueOperator):
    """A flag reads true, or false, whatever it is: an interlock that is bridged, a switch that sticks.

    Where: read flags whose vocabulary names both values.

    Stands for: A sensor that drops out or is misread: {sensors}.
    """

    name = "stuck-flag"
    family = CATALOGUE
    of_written = False
    variants: ClassVar[Mapping[str, bool]] = {"true": True, "false": False}
    examples = (
        Example.changed(_CURTAIN, False, True, "true"),
        Example.changed(_CURTAIN, True, False, "false"),
        Example.unchanged(_CURTAIN, True, "the value would stay the same", "true"),
    )

    def fits(self, quantity: Quantity, whole: Subject) -> bool:
        return quantity.kind is Kind.FLAG and {True, False} == set(quantity.values or ())

    def change(self, value: Any, context: Context) -> Any | None:
        return context.option

    def describe(self, subject: Subject, before: Any | None, after: Any | None) -> str:
        return f"reads {subject.required_quantity.label} as {subject.variant} whatever it is"
