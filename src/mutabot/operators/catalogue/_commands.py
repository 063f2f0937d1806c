"""The shape of operators that act on a command as a whole."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import ClassVar

from mutabot.families import CATALOGUE
from mutabot.model import Call, Operation, Pattern, Reply
from mutabot.operators.operator import Operator, Subject


class CommandFault(Operator):
    """Acts on commands; ``variants`` are a mutant each."""

    family = CATALOGUE
    is_for_oracle = False
    variants: ClassVar[tuple[str, ...]] = ("",)

    def fits(self, whole: Subject) -> bool:
        """Whether it has something to do with this command."""
        return True

    def subjects(self, operation: Operation, pattern: Pattern | None) -> Iterator[Subject]:
        whole = Subject(operation, pattern)
        if whole.is_command and self.fits(whole):
            yield from (replace(whole, variant=variant) for variant in self.variants)


def idle_of(call: Call) -> Reply:
    """What the command answers while the robot does nothing. Raises LookupError if nobody knows."""
    if call.idle is None:
        raise LookupError(f"nobody knows what {call.operation.name} answers to doing nothing")
    return call.idle
