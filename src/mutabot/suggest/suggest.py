"""The whole way from a campaign's survivors to checks that kill them.

Which survivors an observation can kill, which none can, and why no check kills one that it could.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from mutabot.campaign.request import Progress, Request
from mutabot.errors import NothingToDoError
from mutabot.frozen import frozen
from mutabot.model import Mutant
from mutabot.results.results import MutantResult, Results
from mutabot.results.suggested import Dropped, Suggestion, Suggestions, Unsolved

from .checks import ProposedCheck, Trials, candidates, unseen
from .place import OTHER, place_of
from .project import ProjectFiles, diff_of
from .prove import Proof, texts_with
from .readings import Measured, is_number, known, measure

#: how often checks are chosen anew because one of them failed its proof
_ATTEMPTS = 5


def _sorted_out(
    chosen: Sequence[MutantResult],
) -> tuple[dict[str, tuple[Mutant, list[int]]], list[Unsolved], list[str]]:
    """The survivors that may look other than the original, the others, and the tests where the first acted.

    The first by id, with the rounds in which they survived. No check at the ends of these tests can kill the
    others.
    """
    to_kill: dict[str, tuple[Mutant, list[int]]] = {}
    never: list[Unsolved] = []
    tests: dict[str, None] = {}
    for one in chosen:
        different = [out for out in one.survived if out.indistinguishable is not True]
        reason = "no test reaches it; add a test that does"
        if different:
            to_kill[one.mutant.id] = one.mutant, [out.round for out in different]
            tests.update({looked.test: None for out in different for looked in out.looked if looked.acted})
            continue
        if one.survived:
            compared = one.survived[0].compared
            extent = f" in {compared.text}" if compared is not None else " that was compared"
            reason = f"nothing differs{extent} (indistinguishable)"
        never.append(Unsolved(one.mutant.id, reason, never=True))
    return to_kill, never, list(tests)


def why_unsolved(
    mutant: Mutant,
    measured: Measured,
    found: Sequence[ProposedCheck],
    proof: Proof,
    refused: Mapping[str, str],
) -> Unsolved:
    """The reason, with what differs most and how far the original itself spreads."""
    failed = [one for one in found if one in proof.failed and mutant.id in dict(one.trials)]
    if failed:
        return Unsolved(mutant.id, f"a check that would notice it failed its proof: {failed[0].statement}")
    if mutant.id in refused:
        return Unsolved(mutant.id, refused[mutant.id])
    nothing = "nothing differs in what its tests can read at their ends"
    return Unsolved(mutant.id, max(_differences(mutant, measured), default=(0.0, nothing))[1])


def _differences(mutant: Mutant, measured: Measured) -> list[tuple[float, str]]:
    """How far readings are from the original's, in what the original does by itself, each in words."""
    found = []
    for place, by_mutant in measured.mutants.items():
        originals = measured.originals.get(place, {})
        for key, read in by_mutant.get(mutant.id, {}).items():
            for text, value in read.items():
                before = originals.get(key, {}).get(text)
                if not is_number(value) or not is_number(before) or value == before:
                    continue
                values = [one[text] for one in originals.values() if is_number(one.get(text))]
                spread, tolerance = max(values) - min(values), known(measured, place, text).tolerance
                own = f"the original itself spreads {_short(spread)}"
                if tolerance >= spread:
                    own = f"its tolerance is {_short(tolerance)}"
                apart = abs(value - before)
                words = f"{text} differs by {_short(apart)}, {own}"
                found.append((apart / max(spread, tolerance), words))
    return found


def _short(value: float) -> str:
    return repr(float(f"{value:.3g}"))


@frozen
class Quiet:
    """Progress without the remarks of campaigns that only serve."""

    progress: Progress

    def stage(self, text: str, total: int | None = None) -> None:
        """As in ``Progress``."""
        self.progress.stage(text, total)

    def advance(self, line: str | None = None) -> None:
        """As in ``Progress``."""
        self.progress.advance(line)

    def note(self, text: str) -> None:
        """Nothing is told: the campaign itself has told it."""


def suggest(
    request: Request,
    results: Results,
    chosen: Sequence[MutantResult],
    progress: Progress,
    *,
    seeds: int,
) -> Suggestions:
    """Checks that kill these survivors of a finished campaign.

    Args:
        request: as the campaign's was.
        results: of the campaign.
        chosen: the survivors that are to be killed.
        progress: is told.
        seeds: how many fresh seeds are run for the bands, and as many others for the proof.

    Raises NothingToDoError if there is nothing to kill or nothing to look at, and what a campaign raises.
    """
    to_kill, never, tests = _sorted_out(chosen)
    nothing = Suggestions(
        unsolved=tuple(never),
        numbers={one.mutant.id: one.mutant.number for one in chosen},
        descriptions={one.mutant.id: one.mutant.description for one in chosen},
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
    quiet = Quiet(progress)
    project = ProjectFiles(request)
    places = {test: place for test in tests if (place := place_of(project, test)) is not None}
    if not places:
        raise NothingToDoError(
            f"no check can be added to the tests of these survivors, such as {next(iter(tests), 'no test')}: "
            "they are neither functions of pytest, nor methods of unittest, nor made by another tool"
        )
    calibrated = request.rounds + seeds
    measured = measure(replace(request, rounds=calibrated), project, places, list(to_kill.values()), quiet)
    found, refused = candidates(project, measured)
    proof = Proof(request, project, quiet)
    fresh = range(calibrated, calibrated + seeds)
    checks = _proven(proof, found, measured, [*range(request.rounds), *fresh])
    texts = texts_with(project, [one for one in checks if one.place.style != OTHER])
    killed = {mutant for one in checks for mutant, _ in proof.kills[one]}
    left = [mutant for name, (mutant, _) in to_kill.items() if name not in killed]
    return replace(
        nothing,
        suggestions=tuple(_suggestion(one, proof.kills[one], seeds) for one in checks),
        diff=diff_of(request.root, texts),
        unsolved=(*(why_unsolved(one, measured, found, proof, refused) for one in left), *never),
        dropped=tuple(Dropped(one.place.node, one.statement, why) for one, why in proof.failed.items()),
    )


def _proven(
    proof: Proof, found: Sequence[ProposedCheck], measured: Measured, rounds: Sequence[int]
) -> list[ProposedCheck]:
    """Checks that all stand their proof and together kill what any would; those that kill most first."""
    mutants = {place: list(found) for place, found in measured.mutants.items()}
    for _ in range(_ATTEMPTS):
        chosen = chosen_of([one for one in found if one not in proof.failed], proof.kills)
        new = [one for one in chosen if one not in proof.kills]
        if not new:
            break
        proof.on_survivors(proof.on_original(chosen, rounds), mutants)
    chosen = [one for one in chosen if one in proof.kills and one not in proof.failed]
    return sorted(chosen, key=lambda one: -len(proof.kills[one]))


def chosen_of(checks: Sequence[ProposedCheck], kills: Mapping[ProposedCheck, Trials]) -> list[ProposedCheck]:
    """For all that any check kills, the one that a person would rather write; none that others replace.

    ``kills``: what checks that were run killed; of the others counts what they would by what was measured.
    """
    trials = {one: kills.get(one, one.trials) for one in checks}
    left = frozenset().union(*trials.values())
    chosen: list[ProposedCheck] = []
    for one in sorted(checks, key=lambda one: (one.worth, len(trials[one])), reverse=True):
        if trials[one] & left:
            chosen.append(one)
            left -= trials[one]
    for one in list(chosen):
        others = [other for other in chosen if other is not one]
        if trials[one] <= frozenset().union(*(trials[other] for other in others)):
            chosen = others
    return chosen


def _suggestion(check: ProposedCheck, trials: Trials, seeds: int) -> Suggestion:
    added = check.addition()
    is_other = check.place.style == OTHER
    kills: dict[str, tuple[int, ...]] = {}
    for mutant, round in sorted(trials):
        kills[mutant] = (*kills.get(mutant, ()), round)
    return Suggestion(
        test=check.place.node,
        style=check.place.style,
        looks_at=check.reading.text,
        statement=check.statement,
        by_hand="\n".join([*dict.fromkeys(added.imports), *added.lines]) if is_other else "",
        tolerance=check.tolerance,
        spread=check.spread,
        runs=check.runs,
        fresh=seeds,
        unseen=unseen(seeds),
        kills=kills,
    )
