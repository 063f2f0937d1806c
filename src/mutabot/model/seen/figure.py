"""Figures of merit: numbers that a vocabulary says are better if they are less, or more."""

from __future__ import annotations

from collections.abc import Sequence

from mutabot.frozen import frozen


@frozen
class Figure:
    """A figure of merit that a mutant changed by more than its tolerance.

    Attributes:
        probe: what is read, as the vocabulary names it.
        before, after: in the original and in the mutant.
        better: ``less`` or ``more``: which way it gets better.
        test: node id.
    """

    probe: str
    before: float
    after: float
    better: str
    test: str = ""

    @property
    def is_better(self) -> bool:
        """Whether the mutant did better than the original."""
        return self.after < self.before if self.better == "less" else self.after > self.before

    @property
    def text(self) -> str:
        """``Cell.cycle_time 11.2 instead of 12.5``."""
        return f"{self.probe.partition(':')[2]} {self.after:.4g} instead of {self.before:.4g}"


def improvement(figures: Sequence[Figure]) -> str:
    """What got better, in words; empty if nothing did, or if anything got worse."""
    if not figures or not all(one.is_better for one in figures):
        return ""
    best = max(figures, key=lambda one: abs(one.after - one.before) / max(abs(one.before), 1e-12))
    more = f" and {len(figures) - 1} more" if len(figures) > 1 else ""
    return f"{best.text}{more}"
