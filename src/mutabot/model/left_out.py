"""Mutants that were left out, and why."""

from __future__ import annotations

from collections.abc import Iterable

from mutabot.frozen import frozen


@frozen
class LeftOut:
    """A mutant that the plan leaves out because it cannot matter.

    Attributes:
        id: the id it would have had.
        description: what it would have done.
        reason: why it cannot matter.
    """

    id: str
    description: str
    reason: str

    @property
    def heading(self) -> str:
        """The heading of its list: a common one for mutants without effect, otherwise the reason."""
        return NOTHING if self.reason.startswith(NOTHING) else self.reason


#: how the reason begins why a mutant is left out that would change nothing in the calls of the baseline
NOTHING = "would change nothing"


def by_heading(left_out: Iterable[LeftOut]) -> dict[str, list[LeftOut]]:
    """Group by heading: first what would change nothing, then the largest group first."""
    found: dict[str, list[LeftOut]] = {}
    for omission in left_out:
        found.setdefault(omission.heading, []).append(omission)
    return dict(sorted(found.items(), key=lambda item: (item[0] != NOTHING, -len(item[1]))))
