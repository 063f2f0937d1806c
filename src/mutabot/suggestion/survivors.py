"""Which survivors an observation can kill, which none can, and why no check kills one that differs."""

from __future__ import annotations

from collections.abc import Sequence

from mutabot.analysis.results import MutantResult
from mutabot.analysis.suggested import Unsolved
from mutabot.frozen import frozen
from mutabot.model import Mutant, Verdict
from mutabot.suggestion.candidates import part_of_way, tolerance_of
from mutabot.suggestion.checks import Check, decimal, is_number
from mutabot.suggestion.measure import Measured
from mutabot.suggestion.prove import Proof


@frozen
class Survivors:
    """The survivors of a campaign.

    Attributes:
        to_kill: those that look other than the original, or may, with the rounds in which they survived.
        never: those that no observation at the ends or moments of these tests can kill.
        tests: the tests in which any of the first acted, by node id.
    """

    to_kill: tuple[tuple[MutantResult, tuple[int, ...]], ...]
    never: tuple[Unsolved, ...]
    tests: tuple[str, ...]


def survivors_of(chosen: Sequence[MutantResult]) -> Survivors:
    """Sort out survivors."""
    to_kill, never = [], []
    tests: dict[str, None] = {}
    for one in chosen:
        survived = [out for out in one.outcomes if out.verdict is Verdict.SURVIVED]
        different = [out for out in survived if out.indistinguishable is not True]
        if different:
            to_kill.append((one, tuple(out.round for out in different)))
            tests.update({looked.test: None for out in different for looked in out.looked if looked.acted})
        elif survived:
            compared = survived[0].compared
            extent = f" in {compared.text}" if compared is not None else " that was compared"
            reason = f"nothing differs{extent} (indistinguishable)"
            never.append(Unsolved(one.mutant.id, reason, never=True))
        else:
            reason = "no test reaches it: it needs a test that does, not a check"
            never.append(Unsolved(one.mutant.id, reason, never=True))
    return Survivors(tuple(to_kill), tuple(never), tuple(tests))


@frozen
class _Nearest:
    """What differs most on a mutant: the expression, by how much, and what is no difference in it."""

    text: str
    apart: float
    spread: float
    tolerance: float

    @property
    def rank(self) -> float:
        """How far it is, in what the original does by itself."""
        return self.apart / max(self.spread, self.tolerance)

    @property
    def words(self) -> str:
        """``box.x differs by 0.003, the original itself spreads 0.005``."""
        part = part_of_way(self.text)
        where = self.text if part is None else f"on the way, the {part[0]} of {part[1]}"
        own = f"the original itself spreads {_short(self.spread)}"
        if self.tolerance >= self.spread:
            own = f"its tolerance is {_short(self.tolerance)}"
        return f"{where} differs by {_short(self.apart)}, {own}"


def why_unsolved(mutant: Mutant, measured: Measured, found: Sequence[Check], proof: Proof) -> Unsolved:
    """The reason, with what differs most and how far the original itself spreads."""
    failed = [one for one in found if one in proof.failed and mutant.id in one.margins]
    if failed:
        return Unsolved(mutant.id, f"what would notice it failed its proof: {failed[0].statement}")
    nearest = max(_differences(mutant, measured), key=lambda one: one.rank, default=None)
    if nearest is None:
        return Unsolved(mutant.id, "nothing differs that its tests can read at their ends or after a command")
    return Unsolved(mutant.id, nearest.words)


def _differences(mutant: Mutant, measured: Measured) -> list[_Nearest]:
    found = []
    for place, by_mutant in measured.mutants.items():
        originals = measured.originals.get(place, {})
        for key, read in by_mutant.get(mutant.id, {}).items():
            same = originals.get(key, {})
            for text, value in read.items():
                before = same.get(text)
                if is_number(value) and is_number(before) and abs(value - before) > 0:
                    values = [one[text] for one in originals.values() if is_number(one.get(text))]
                    spread = max(values) - min(values)
                    tolerance = tolerance_of(measured, place, text)
                    found.append(_Nearest(text, abs(value - before), spread, tolerance))
    return found


def _short(value: float) -> str:
    return decimal(float(f"{value:.3g}"))
