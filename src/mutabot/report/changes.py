"""What became of survivors since an older campaign, as the same sections on the terminal and in Markdown.

Mutants are the same if their ids are. A mutant is a survivor if any round lets it through. Only what was
judged can be fixed: a survivor that is refused, unstable, not run or not there in the new campaign is told
apart.
"""

from __future__ import annotations

from collections.abc import Iterator

from mutabot.results.results import MutantResult, Results

from .sections import MUTANT_COLUMNS, Place, Section, mutant_cells, percent
from .texts import rounds_text


def changes(old: Results, new: Results, place: Place) -> Iterator[Section]:
    """Yield how complete the campaigns are, the scores, and the survivors that changed, new ones first."""
    for name, campaign in (("older", old), ("new", new)):
        if not campaign.is_complete:
            yield Section(f"The {name} campaign is not complete: {campaign.state}", is_alarm=True)
    yield Section("Scores", ("family · role", ">old", ">new", ">points"), [*_score_rows(old, new)])
    before, after = ({one.mutant.id: one for one in campaign.mutants} for campaign in (old, new))
    survived, survives = ({one.mutant.id for one in campaign.survivors} for campaign in (old, new))
    lost = [one for one in old.worst_first if one.mutant.id in survived - survives]
    found = {
        "New survivors": [one for one in new.worst_first if one.mutant.id in survives - survived],
        "Survivors with unknown state now": [one for one in lost if not _is_judged(after.get(one.mutant.id))],
        "Fixed survivors": [one for one in lost if _is_judged(after.get(one.mutant.id))],
    }
    for name, those in found.items():
        rows = [
            (*mutant_cells(one, place), f"{_end(after.get(one.id))}; before: {_end(before.get(one.id))}")
            for one in (result.mutant for result in those)
        ]
        yield Section(f"{name}: {len(rows)}", (*MUTANT_COLUMNS, "*result") if rows else (), rows)
    yield Section(f"Survivors as before: {len(survives & survived)}")


def _is_judged(result: MutantResult | None) -> bool:
    """Whether all its rounds were run, and it stood in the score of at least one."""
    return result is not None and result.kill_rate.valid > 0 and None not in result.rounds


def _end(result: MutantResult | None) -> str:
    return rounds_text(result) if result is not None else "not in the campaign"


def _score_rows(old: Results, new: Results) -> Iterator[tuple[str, ...]]:
    """Family and role, the old score, the new one, and the difference in percentage points."""
    before, after = (
        {f"{one.family} · {one.role}": one.scores.mean for one in each.groups} for each in (old, new)
    )
    for name in {**before, **after}:
        was, becomes = before.get(name), after.get(name)
        by = f"{100 * (becomes - was):+.1f}" if was is not None and becomes is not None else "–"
        yield name, percent(was), percent(becomes), by
