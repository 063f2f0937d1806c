"""Two campaigns side by side: which mutants survive now that did not, and the other way round.

Mutants are the same if their ids are. A mutant is a survivor if any round lets it through. Only what was
judged can be fixed: a survivor that is refused, unstable or not run in the other campaign is told apart.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping

from mutabot.analysis.results import MutantResult, Results
from mutabot.analysis.score import Group
from mutabot.frozen import frozen


@frozen
class Pair:
    """A mutant in both campaigns.

    Attributes:
        old, new: what became of it; None in a campaign that has no such mutant.
    """

    old: MutantResult | None
    new: MutantResult | None

    @property
    def either(self) -> MutantResult:
        """Its newest result."""
        found = self.new or self.old
        assert found is not None
        return found


@frozen
class Changes:
    """What differs between an old campaign and a new one.

    Attributes:
        appeared: survivors of the new one that the old one did not let through, or did not have.
        fixed: survivors of the old one that the new one kills in every round in which they are valid.
        changed: survivors of both that are let through in another share of rounds, or of which only one of
            the campaigns shows anything that differs from the original.
        same: number of survivors of both that are not in ``changed``.
        unknown: survivors of the old one of which the new one says nothing: not run, or outside the score.
        gone: mutants that only the old one has, of families that were asked for in the new one.
        added: mutants that only the new one has, of families that were asked for in the old one.
        scores: the old and the new scores per family and role; None where a campaign has none of them.
        old_state, new_state: how the campaigns ended.
        notes: what else is to be known of the campaigns before they are compared, a sentence each.
    """

    appeared: tuple[Pair, ...]
    fixed: tuple[Pair, ...]
    changed: tuple[Pair, ...]
    same: int
    unknown: tuple[Pair, ...]
    gone: tuple[MutantResult, ...]
    added: tuple[MutantResult, ...]
    scores: Mapping[tuple[str, str], tuple[Group | None, Group | None]]
    old_state: str
    new_state: str
    notes: tuple[str, ...] = ()


def changes(old: Results, new: Results) -> Changes:
    """Compare two campaigns."""
    before = {one.mutant.id: one for one in old.mutants}
    after = {one.mutant.id: one for one in new.mutants}
    pairs = [Pair(before.get(one.mutant.id), one) for one in _worst_first(new)]
    both = [pair for pair in pairs if _is_survivor(pair.old) and _is_survivor(pair.new)]
    changed = [pair for pair in both if _told(pair.old) != _told(pair.new)]
    lost = [Pair(one, after.get(one.mutant.id)) for one in _worst_first(old) if one.is_survivor]
    lost = [pair for pair in lost if pair.new is not None and not pair.new.is_survivor]
    return Changes(
        appeared=tuple(pair for pair in pairs if _is_survivor(pair.new) and not _is_survivor(pair.old)),
        fixed=tuple(pair for pair in lost if _is_judged(pair.new)),
        changed=tuple(changed),
        same=len(both) - len(changed),
        unknown=tuple(pair for pair in lost if not _is_judged(pair.new)),
        gone=tuple(one for one in _asked_for(new, old.mutants) if one.mutant.id not in after),
        added=tuple(one for one in _asked_for(old, new.mutants) if one.mutant.id not in before),
        scores=_scores(old.groups, new.groups),
        old_state=old.state,
        new_state=new.state,
        notes=(*_notes("new", new, old), *_notes("old", old, new)),
    )


def _asked_for(results: Results, mutants: Iterable[MutantResult]) -> list[MutantResult]:
    """The mutants of families that a campaign had; all of them if it does not say which."""
    families = results.meta.get("families")
    return [one for one in mutants if families is None or one.mutant.family in families]


def _notes(name: str, results: Results, other: Results) -> Iterator[str]:
    """What a campaign did not look at, so that nobody takes it for gone or new."""
    asked = {one.mutant.id for one in _asked_for(results, other.mutants)}
    missing = [one.mutant.family for one in other.mutants if one.mutant.id not in asked]
    for family, count in Counter(missing).items():
        yield f"the {name} campaign was not to run family {family}; mutants that are not compared: {count}"
    if results.drawing is not None:
        yield f"the {name} campaign is of a sample: mutants that it does not have may not have been drawn"


def _worst_first(results: Results) -> list[MutantResult]:
    survivors = results.survivors
    ids = {one.mutant.id for one in survivors}
    return [*survivors, *(one for one in results.mutants if one.mutant.id not in ids)]


def _is_survivor(result: MutantResult | None) -> bool:
    return result is not None and result.is_survivor


def _is_judged(result: MutantResult | None) -> bool:
    """Whether all its rounds were run, and it stood in the score of at least one."""
    return result is not None and result.kill_rate.valid > 0 and None not in result.rounds


def _told(result: MutantResult | None) -> tuple[float | None, bool] | None:
    """What of a survivor is compared: numbers of its probes differ a little from machine to machine."""
    return (result.kill_rate.rate, result.indistinguishable) if result is not None else None


def _scores(
    old: Iterable[Group], new: Iterable[Group]
) -> dict[tuple[str, str], tuple[Group | None, Group | None]]:
    before = {(group.family, group.role): group for group in old}
    after = {(group.family, group.role): group for group in new}
    return {key: (before.get(key), after.get(key)) for key in {**before, **after}}
