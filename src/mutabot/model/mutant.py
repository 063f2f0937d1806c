"""Mutants: one operator applied at one site, to one quantity or to the whole call."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from mutabot.families import CALLS
from mutabot.frozen import frozen
from mutabot.model.values.notation import Notation

from .moment import Moment
from .site import Site


@frozen
class Mutant:
    """One planted fault.

    Attributes:
        number: 1, 2, 3 … in the order of the plan.
        family: the family of its operator (``mutabot.families``).
        operator: name of the operator.
        site: where it acts.
        operation: target of the operation whose calls it acts on; empty if it acts on none.
        pattern: notation of the text command it acts on; None where that does not apply.
        quantity: name of the quantity it changes; None if it concerns the call as a whole.
        variant: which of several mutants of the same operator here; empty if there is only one.
        description: one line that an engineer recognises.
        idle: for operators that ask, what the operation answers while the robot does nothing: a plain value,
            or the data of ``idle.Idle``.
        magnitude: how big its fault is, in ``unit``; None for a fault without a size.
        unit: the unit of the magnitude; None where it has none.
        has_sizes: whether the same fault is planted in several magnitudes, of which a threshold is sought.
        direction: which way a fault with sizes goes: ``+``, ``-``, or empty if it goes one way only.
        moment: at which of its calls it acts; None for all of them.
        provider: name of the provider that made it (``mutabot.faults``).
    """

    number: int
    family: str
    operator: str
    site: Site
    operation: str
    pattern: str | None
    quantity: str | None
    variant: str
    description: str
    idle: Any = None
    magnitude: float | None = None
    unit: str | None = None
    direction: str = ""
    moment: Moment | None = None
    has_sizes: bool = False
    provider: str = CALLS

    @property
    def id(self) -> str:
        """Stable under edits elsewhere: file, function, text, occurrence, quantity, operator."""
        from_pattern = f"{self.pattern_name}" if self.pattern is not None else ""
        subject = "/".join(part for part in (from_pattern, self.quantity) if part) or "call"
        variant = f"={self.variant}" if self.variant else ""
        if self.moment is not None:
            variant += f"@{self.moment.text}"
        if not self.operation:
            return f"{self.site.id}:{self.operator}{variant}"
        return f"{self.site.id}:{subject}:{self.operator}{variant}"

    @property
    def ladder(self) -> str:
        """What all magnitudes of a fault with sizes share: its id without the magnitude; else empty."""
        if not self.has_sizes:
            return ""
        return replace(self, variant=self.direction).id

    @property
    def pattern_name(self) -> str:
        """The pattern without format specifications; empty if there is none."""
        return Notation.compile(self.pattern).short if self.pattern is not None else ""
