"""Which survivors an observation can kill, which none can, and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mutabot.analysis.results import MutantResult
from mutabot.analysis.suggested import Unsolved
from mutabot.model import Verdict


@dataclass(frozen=True, slots=True)
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
