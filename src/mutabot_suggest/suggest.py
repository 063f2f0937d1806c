"""Find checks that kill the survivors of a campaign."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from mutabot.api.processes import Request
from mutabot.api.reports import MutabotError, MutantResult, Progress

from .bands import unseen
from .candidates import candidates
from .checks import CheckProposal, Trials
from .places import chosen_places, other_places
from .project import OTHER, PlaceInTest, SuiteFiles
from .proof import Proof, texts_with
from .readings import Measured, Survivors, measure, merged
from .reasons import NOT_REACHED, NOTHING_DIFFERS, why_unsolved
from .results import Dropped, NothingToSuggestError, ProvenCheck, Suggestions, Unsolved
from .suite import SuiteChecks
from .zones import monitors

#: how often checks are chosen anew because one of them failed its proof, and failures after which a test is
#: left alone: with other seeds it ends otherwise
_ATTEMPTS, _FAILURES = 8, 3


def _separated(chosen: Sequence[MutantResult]) -> tuple[Survivors, list[Unsolved]]:
    """Separate the survivors that may differ from the original, with the rounds in which they do.

    No check is searched for the others: nothing that was compared differs, or no test reaches them. Where the
    world is not recorded, a test may read what no probe does, such as a counter of its fake.
    """
    to_kill: Survivors = {}
    never: list[Unsolved] = []
    outcomes = [out for result in chosen for out in result.survived]
    is_recorded = any(divergence.apart for out in outcomes for divergence in out.diverged)
    for result in chosen:
        survived = result.survived
        different = [out for out in survived if out.indistinguishable is not True or not is_recorded]
        if different and any(looked.acted for out in different for looked in out.looked):
            to_kill[result.mutant.id] = result, [out.round for out in different]
        else:
            reason = NOTHING_DIFFERS if result.survived and not different else NOT_REACHED
            never.append(Unsolved(result.mutant.id, reason, never=True))
    return to_kill, never


class QuietProgress:
    """Progress without the notes of auxiliary campaigns."""

    left: float | None = None

    def __init__(self, progress: Progress) -> None:
        self.stage, self.advance = progress.stage, progress.advance
        self.mutant_ended = progress.mutant_ended

    def note(self, text: str) -> None:
        """Print nothing: the user's campaign has already printed the note."""


def suggest(
    request: Request, chosen: Sequence[MutantResult], progress: Progress, *, seeds: int
) -> Suggestions:
    """Suggest checks that kill these survivors of a finished campaign.

    Args:
        request: as the campaign's was.
        chosen: the survivors that are to be killed.
        progress: shows what is going on.
        seeds: how many fresh seeds are run to find values and tolerances, and as many others for the proof.

    Raises NothingToSuggestError if there is nothing to kill or to look at, and what a campaign raises.
    """
    to_kill, never = _separated(chosen)
    nothing = Suggestions(
        unsolved=tuple(never),
        numbers={result.mutant.id: result.mutant.number for result in chosen},
        descriptions={result.mutant.id: result.mutant.description for result in chosen},
        rounds=request.rounds,
        seeds=seeds,
    )
    if not request.vocabulary.probes:
        progress.note(
            "the vocabulary has no [[probe]]: checks can use only the oracle's readings and the tests' values"
        )
    elif not to_kill:
        progress.note("nothing differs in any survivor; another [[probe]] may show a difference")
    if not to_kill:
        return nothing
    quiet = QuietProgress(progress)
    request = replace(request, evidence=False)
    project = SuiteFiles(request)
    places = chosen_places(project, [result for result, _ in to_kill.values()])
    if not places:
        tests = (
            looked.test for result, _ in to_kill.values() for out in result.survived for looked in out.looked
        )
        raise NothingToSuggestError(
            f"no check can be added to the tests of these survivors, such as {next(tests, 'no test')}: "
            "they are neither functions of pytest, nor methods of unittest, nor made by another tool"
        )
    project.tests = tuple(dict.fromkeys(place.file for place in places))
    suite = SuiteChecks.of(project)
    calibrated = request.rounds + seeds
    wide = replace(request, rounds=calibrated)
    measured = _measured(wide, project, suite, places, to_kill, quiet)
    found, refused = _proposals(project, suite, measured)
    noticed = {mutant for proposal in found for mutant, _ in proposal.trials}
    unnoticed = {mutant: entry for mutant, entry in to_kill.items() if mutant not in noticed}
    others = other_places(project, chosen, [result for result, _ in unnoticed.values()], places)
    if others:
        measured = merged(measured, _measured(wide, project, suite, others, unnoticed, quiet))
        found, refused = _proposals(project, suite, measured)
    proof = Proof(request, project, quiet, needs_all=measured.needs_all)
    checks = _proven(proof, found, [*range(request.rounds), *range(calibrated, calibrated + seeds)])
    killed = {mutant for check in checks for mutant, _ in proof.kills[check]}
    left = [result for mutant, (result, _) in to_kill.items() if mutant not in killed]
    reasons = [why_unsolved(result, measured, suite, found, proof.failed, refused) for result in left]
    texts = texts_with(project, [check for check in checks if check.place.style != OTHER])
    return replace(
        nothing,
        checks=tuple(_suggestion(check, proof.kills[check], seeds) for check in checks),
        diff=project.diff(texts),
        unsolved=(*reasons, *never),
        dropped=tuple(
            Dropped(proposal.place.node, proposal.statement, why) for proposal, why in proof.failed.items()
        ),
    )


def _proposals(
    project: SuiteFiles, suite: SuiteChecks, measured: Measured
) -> tuple[list[CheckProposal], dict[str, str]]:
    """Return the checks that would notice survivors; and by mutant, what would notice it and is no check."""
    found, refused = candidates(project, suite, measured)
    return [*found, *monitors(suite, measured)], refused


def _measured(
    request: Request,
    project: SuiteFiles,
    suite: SuiteChecks,
    places: Sequence[PlaceInTest],
    survivors: Survivors,
    progress: Progress,
) -> Measured:
    """Return what these tests read; if they need what others leave behind, run all tests."""
    tests = tuple(place.node for place in places)
    try:
        measured = measure(request.changed(tests=tests), project, suite, places, survivors, progress)
    except MutabotError:  # they fail without the others
        measured = None
    if measured is not None and not measured.lost:
        return measured
    return replace(measure(request, project, suite, places, survivors, progress), needs_all=True)


def _proven(proof: Proof, found: Sequence[CheckProposal], rounds: Sequence[int]) -> list[CheckProposal]:
    """Return proven checks that together kill all that any check kills, those that kill most first."""
    for _ in range(_ATTEMPTS):
        failures = Counter(proposal.place for proposal, why in proof.failed.items() if "fails in" in why)
        left = [
            proposal
            for proposal in found
            if proposal in proof.kills
            or (proposal not in proof.failed and failures[proposal.place] < _FAILURES)
        ]
        chosen = chosen_of(left, proof.kills)
        new = [proposal for proposal in chosen if proposal not in proof.kills]
        if not new:
            break
        proof.on_survivors(proof.on_original(new, rounds))
    chosen = [proposal for proposal in chosen if proposal in proof.kills and proposal not in proof.failed]
    return sorted(chosen, key=lambda proposal: -len({mutant for mutant, _ in proof.kills[proposal]}))


def chosen_of(checks: Sequence[CheckProposal], kills: Mapping[CheckProposal, Trials]) -> list[CheckProposal]:
    """Return the fewest checks that kill all that any kills, preferring those that a person would write.

    ``kills``: what checks that were run killed; of the others counts what they would by what was measured.
    """
    trials = {proposal: kills.get(proposal, proposal.trials) for proposal in checks}
    left = frozenset().union(*trials.values())
    chosen: list[CheckProposal] = []
    for best in sorted(checks, key=lambda proposal: (proposal.worth, len(trials[proposal])), reverse=True):
        if trials[best] & left:
            chosen.append(best)
            left -= trials[best]
    for chosen_check in chosen[::-1]:  # the best is the last to go
        others = [other for other in chosen if other is not chosen_check]
        if trials[chosen_check] <= frozenset().union(*(trials[other] for other in others)):
            chosen = others
    return chosen


def _suggestion(check: CheckProposal, trials: Trials, seeds: int) -> ProvenCheck:
    kills: dict[str, tuple[int, ...]] = {}
    for mutant, round in sorted(trials):
        kills[mutant] = (*kills.get(mutant, ()), round)
    return ProvenCheck(
        test=check.place.node,
        style=check.place.style,
        looks_at=check.looks_at,
        statement=check.statement,
        by_hand=_by_hand(check) if check.place.style == OTHER else "",
        tolerance=check.tolerance,
        spread=check.spread,
        runs=check.runs,
        fresh=seeds,
        unseen=unseen(seeds),
        after=check.after,
        kills=kills,
    )


def _by_hand(check: CheckProposal) -> str:
    added = check.addition()
    return "\n".join([*_unique(added.imports), *added.lines])


def _unique(lines: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(lines))
