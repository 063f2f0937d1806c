"""Mutants of earlier campaigns: a campaign of a few mutants leaves the others as they were.

They stay in the journal with their outcomes, and reports show them beside those of the last campaign.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from mutabot.campaign.request import Request
from mutabot.campaign.reuse.keys import Dependencies
from mutabot.journal.journal import Journal
from mutabot.journal.records import Kept
from mutabot.model import Mutant


def carry(
    known: Iterable[Mutant], request: Request, planned: Sequence[Mutant], whole: Iterable[Mutant]
) -> list[Mutant]:
    """The mutants of earlier campaigns that the program still has and that are not planned now.

    ``whole``: all that the program has now, of the families of this campaign, with their numbers. Mutants of
    other families are kept, for of these nothing is known now. A number that is taken gives way.
    """
    now = {mutant.id: mutant for mutant in whole}
    done = {mutant.id for mutant in planned}
    found = [
        now.get(mutant.id, mutant)
        for mutant in known
        if mutant.id not in done and (mutant.id in now or mutant.family not in request.families)
    ]
    return renumbered(found, planned)


def renumbered(mutants: Sequence[Mutant], planned: Sequence[Mutant]) -> list[Mutant]:
    """Mutants beside a plan, by number; a number that is taken gives way."""
    taken = {mutant.number for mutant in planned}
    last = max((mutant.number for mutant in (*planned, *mutants)), default=0)
    found = []
    for mutant in sorted(mutants, key=lambda mutant: mutant.number):
        if mutant.number in taken:
            last += 1
            found.append(replace(mutant, number=last))
        else:
            found.append(mutant)
        taken.add(found[-1].number)
    return found


def note_outdated(journal: Journal, request: Request, dependencies: Dependencies) -> None:
    """Find out which mutants of earlier campaigns depend on something that has changed since."""
    known = [mutant for mutant, _ in journal.known()]
    if not known:
        return
    kept = journal.kept()
    journal.set_known(
        [(mutant, _is_outdated(mutant, journal, kept, request, dependencies)) for mutant in known]
    )
    journal.add_parts(dependencies.new_parts())


def _is_outdated(
    mutant: Mutant,
    journal: Journal,
    kept: dict[tuple[str, int], Kept],
    request: Request,
    dependencies: Dependencies,
) -> bool:
    for round in range(request.rounds):
        outcome = kept.get((mutant.id, round))
        if outcome is None:
            return True
        if mutant.family not in request.families:
            if not dependencies.still_hold(outcome.key, journal.parts(outcome.key.split()[1]) or {}):
                return True
        elif dependencies.holding(outcome.key, mutant, round) is None:
            return True
    return False
