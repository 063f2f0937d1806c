"""Why no check kills a survivor that looks other than the original."""

from __future__ import annotations

from collections.abc import Sequence

from mutabot.analysis.suggested import Unsolved
from mutabot.model import Mutant
from mutabot.suggestion.choosing.bands import decimal
from mutabot.suggestion.choosing.checks import Check, is_number
from mutabot.suggestion.measuring.measure import Measured

from .prove import Proof


def why_unsolved(mutant: Mutant, measured: Measured, found: Sequence[Check], proof: Proof) -> Unsolved:
    """The reason, with what differs most and how far the original itself spreads."""
    failed = [one for one in found if one in proof.failed and mutant.id in one.margins]
    if failed:
        return Unsolved(mutant.id, f"what would notice it failed its proof: {failed[0].statement}")
    nearest = _nearest(mutant, measured)
    if nearest is None:
        reason = "at the ends of its tests nothing that can be read there differs"
        return Unsolved(mutant.id, reason)
    text, apart, spread = nearest
    reason = f"{text} differs by {_short(apart)}, the original itself spreads {_short(spread)}"
    return Unsolved(mutant.id, reason)


def _nearest(mutant: Mutant, measured: Measured) -> tuple[str, float, float] | None:
    """What differs most against the original's spread: its text, the difference, the spread."""
    best: tuple[float, str, float, float] | None = None
    for place, by_mutant in measured.mutants.items():
        originals = measured.originals.get(place, {})
        for key, read in by_mutant.get(mutant.id, {}).items():
            same = originals.get(key, {})
            for text, value in read.items():
                if not (is_number(value) and is_number(same.get(text))):
                    continue
                apart = abs(value - same[text])
                values = [one[text] for one in originals.values() if is_number(one.get(text))]
                spread = max(values) - min(values)
                rank = apart / spread if spread > 0 else apart * 1e6
                if apart > 1e-9 and (best is None or rank > best[0]):
                    best = (rank, text, apart, spread)
    return best[1:] if best is not None else None


def _short(value: float) -> str:
    return decimal(float(f"{value:.3g}"))
