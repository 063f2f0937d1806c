"""Since a revision: which mutants the changes can have altered, and what is taken over of the others."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from mutabot.border.codec import to_data
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.plan.planned import Plan
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.reuse.keys import Dependencies, says_same
from mutabot.campaign.reuse.reasons import apart
from mutabot.campaign.reuse.reuse import GONE, Pair, Reused
from mutabot.errors import ConfigurationError, JournalError, UsageError
from mutabot.journal.files import find_journal
from mutabot.journal.journal import Journal
from mutabot.journal.reader import JournalReader
from mutabot.journal.records import SINCE, Since
from mutabot.journal.tracked import refuse_tracked
from mutabot.model import Mutant

from .git import Revision
from .then import dependencies_then


def open_others(request: Request, progress: Progress) -> list[JournalReader]:
    """The journal that was named beside the project's own, if it can be read.

    Raises UsageError if there is none and nothing else says what to run, and JournalError for one that git
    tracks.
    """
    if request.other_journal is None:
        return []
    path = find_journal(request.other_journal) if request.other_journal.is_dir() else request.other_journal
    own = request.journal_path
    if path.is_file() and own.is_file() and path.samefile(own):
        return []
    refuse_tracked(path)  # before all that might only be noted
    try:
        return [JournalReader.open(path)]
    except JournalError as error:
        if request.since is None:
            raise UsageError(f"--journal: {error}") from error
        progress.note(f"--journal: {error}; nothing is taken over from it")
        return []


@dataclass(frozen=True, slots=True)
class Altered:
    """Which mutants the changes since a revision can have altered.

    Attributes:
        revision: the revision.
        why: by mutant and round, why; those that are missing cannot have been altered.
    """

    revision: Revision
    why: dict[Pair, str]

    @classmethod
    def of(
        cls,
        revision: Revision,
        campaign: Campaign,
        tests: Iterable[str],
        now: Dependencies,
        mutants: Sequence[Mutant],
    ) -> Altered:
        """Compare the files of the revision with those of now."""
        request = campaign.request
        pairs = [(mutant, round) for round in range(request.rounds) for mutant in mutants]
        try:
            then = dependencies_then(revision, request, campaign.baseline, tests, now)
        except ConfigurationError as error:
            campaign.progress.note(f"{error}; so everything counts as changed")
            reason = f"the configuration of {revision.ref} cannot be read"
            return cls(revision, {(mutant.id, round): reason for mutant, round in pairs})
        why = {}
        for mutant, round in pairs:
            if not says_same(now.keys(mutant, round)[0], then.keys(mutant, round)[0]):
                why[mutant.id, round] = apart(then, now, mutant, round)
        return cls(revision, why)


def only_altered(
    journal: Journal, altered: Altered, found: Reused, plan: Plan, rounds: int, progress: Progress
) -> Plan:
    """The plan without mutants of which nothing is known nor run.

    What the changes cannot have altered is not run, also where no journal holds an outcome of it: ``found``
    says so from then on.
    """
    pairs = [(mutant.id, round) for round in range(rounds) for mutant in plan.mutants]
    why = {**altered.why, **{pair: GONE for pair, reason in found.why.items() if reason == GONE}}
    left = [pair for pair in pairs if pair not in found.done and pair not in why]
    run = {pair: reason for pair, reason in why.items() if pair not in found.done}
    reasons = Counter(_why_not_taken(found, pair) for pair in left)
    since = Since(
        ref=altered.revision.ref,
        commit=altered.revision.commit,
        run=dict(Counter(run.values()).most_common()),
        taken_over=len(found.done),
        not_judged=dict(reasons.most_common()),
    )
    _tell(since, altered.revision.short, progress)
    journal.set_meta(SINCE, to_data(since))
    known = {mutant for mutant, _ in found.done | run.keys()}
    kept = [mutant for mutant in plan.mutants if mutant.id in known]
    journal.keep_planned(known)
    found.done.update(left)
    return Plan(kept, plan.left_out, plan.drawing)


def _why_not_taken(found: Reused, pair: Pair) -> str:
    if pair in found.unsound:
        return "they ended in an error or unstable"
    return found.why.get(pair, "no journal holds an outcome of them")


def _tell(since: Since, short: str, progress: Progress) -> None:
    """Print what is run and what is not, by the kind of reason."""
    total = sum(since.run.values())
    unjudged = sum(since.not_judged.values())
    progress.note(
        f"since {short}: {total} to run, {since.taken_over} taken over"
        + (f", {unjudged} not judged" if unjudged else "")
    )
    for why, count in since.run.items():
        progress.note(f"  {count} to run: {why}")
    for why, count in since.not_judged.items():
        progress.note(f"  {count} not judged, though no change can have altered them: {why}")
