"""Evidence of a mutant at work: what it met, did and was refused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from mutabot.model.outcome import added

from .exception_groups import leaves

#: refusals of one test that are kept
REFUSALS = 16


@dataclass(slots=True)
class Evidence:
    """What a mutant did in the running test.

    Attributes:
        hits: calls at its site.
        acted: hits at which it changed something.
        example: value before and after, at the first hit at which it acted.
        refusals: the exceptions by which the robot refused mutated calls, the latest last; not all of many.
        said: how the robot refused a mutated call by data, in words; None if it did not.
        invalid: whether a mutated call rejected its arguments' types.
        failure: what went wrong in the tool or the operator itself, or None.
        is_of_text: whether the mutant is one of the program text, which makes no calls itself: a refusal
            then counts only if it ends the test.
        is_unknown: whether what the robot refused is no command at all.
        away: hits at which it stayed away, by the reason, as far as the operator says.
    """

    hits: int = 0
    acted: int = 0
    example: tuple[Any, ...] | None = None
    refusals: tuple[BaseException, ...] = ()
    said: str | None = None
    invalid: bool = False
    failure: str | None = None
    is_of_text: bool = False
    is_unknown: bool = False
    away: dict[str, int] = field(default_factory=dict)

    @property
    def culprits(self) -> frozenset[int]:
        """The refusals and all that they hold, each by its ``id``."""
        return frozenset(id(leaf) for refusal in self.refusals for leaf in (refusal, *leaves(refusal)))

    @property
    def refusal(self) -> str | None:
        """How the robot refused a mutated call, in its own words; None if it did not."""
        return str(leaves(self.refusals[-1])[0]) if self.refusals else self.said


def together(found: Sequence[Evidence]) -> Evidence:
    """The evidence of several mutants that are one: it acts if all of them do."""
    if len(found) == 1:
        return found[0]
    return Evidence(
        hits=min((one.hits for one in found), default=0),
        acted=min((one.acted for one in found), default=0),
        example=next((one.example for one in found if one.example is not None), None),
        refusals=tuple(refusal for one in found for refusal in one.refusals),
        said=next((one.said for one in found if one.said is not None), None),
        invalid=any(one.invalid for one in found),
        failure=next((one.failure for one in found if one.failure is not None), None),
        is_of_text=any(one.is_of_text for one in found),
        is_unknown=any(one.is_unknown for one in found),
        away=added(one.away for one in found),
    )
