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

from .bands import decimal, is_number, unseen
from .checks import ProposedCheck, candidates, known
from .measure import Measured, measure
from .place import OTHER, PlaceInTest, place_of
from .project import ProjectFiles, diff_of
from .prove import Proof, texts_with

#: how often checks are chosen anew because one of them failed its proof
_ATTEMPTS = 5


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
        different = [out for out in one.survived if out.indistinguishable is not True]
        if different:
            to_kill.append((one, tuple(out.round for out in different)))
            tests.update({looked.test: None for out in different for looked in out.looked if looked.acted})
        elif one.survived:
            compared = one.survived[0].compared
            extent = f" in {compared.text}" if compared is not None else " that was compared"
            reason = f"nothing differs{extent} (indistinguishable)"
            never.append(Unsolved(one.mutant.id, reason, never=True))
        else:
            reason = "no test reaches it; add a test that does"
            never.append(Unsolved(one.mutant.id, reason, never=True))
    return Survivors(tuple(to_kill), tuple(never), tuple(tests))


def why_unsolved(
    mutant: Mutant,
    measured: Measured,
    found: Sequence[ProposedCheck],
    proof: Proof,
    refused: Mapping[str, str],
) -> Unsolved:
    """The reason, with what differs most and how far the original itself spreads."""
    failed = [one for one in found if one in proof.failed and mutant.id in one.noticed]
    if failed:
        return Unsolved(mutant.id, f"a check that would notice it failed its proof: {failed[0].statement}")
    if mutant.id in refused:
        return Unsolved(mutant.id, refused[mutant.id])
    nearest = max(_differences(mutant, measured), default=None)
    return Unsolved(
        mutant.id, nearest[1] if nearest else "nothing differs in what its tests can read at their ends"
    )


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
    return decimal(float(f"{value:.3g}"))


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
    survivors = survivors_of(chosen)
    if not request.vocabulary.probes:
        progress.note(
            "the vocabulary has no [[probe]]: checks can use only the oracle's readings and the tests' values"
        )
    elif not survivors.to_kill:
        progress.note("nothing differs in any survivor; another [[probe]] may show a difference")
    if not survivors.to_kill:
        return _told(Suggestions(unsolved=survivors.never), chosen, request, seeds)
    quiet = Quiet(progress)
    project = ProjectFiles(request)
    places, without = _places(project, survivors.tests)
    if not places:
        shown = next(iter(without), "no test")
        raise NothingToDoError(
            f"no check can be added to the tests of these survivors, such as {shown}: they are "
            "neither functions of pytest, nor methods of unittest, nor made by another tool"
        )
    calibrated = request.rounds + seeds
    measured = measure(
        replace(request, rounds=calibrated), project, places,
        [(one.mutant, rounds) for one, rounds in survivors.to_kill], quiet,
    )  # fmt: skip
    found, refused = candidates(project, measured)
    proof = Proof(request, project, quiet)
    fresh = range(calibrated, calibrated + seeds)
    chosen_checks = _proven(proof, found, measured, [*range(request.rounds), *fresh])
    texts = texts_with(project, [one for one in chosen_checks if one.place.style != OTHER])
    suggestions = tuple(_suggestion(one, proof.kills[one], seeds) for one in chosen_checks)
    killed = {mutant for one in suggestions for mutant in one.kills}
    left = [one.mutant for one, _ in survivors.to_kill if one.mutant.id not in killed]
    unsolved = [*(why_unsolved(one, measured, found, proof, refused) for one in left), *survivors.never]
    dropped = tuple(Dropped(one.place.node, one.statement, why) for one, why in proof.failed.items())
    whole = Suggestions(suggestions, diff_of(request.root, texts), tuple(unsolved), dropped)
    return _told(whole, chosen, request, seeds)


def _told(whole: Suggestions, chosen: Sequence[MutantResult], request: Request, seeds: int) -> Suggestions:
    return replace(
        whole,
        numbers={one.mutant.id: one.mutant.number for one in chosen},
        descriptions={one.mutant.id: one.mutant.description for one in chosen},
        rounds=request.rounds,
        seeds=seeds,
    )


def _places(project: ProjectFiles, tests: Sequence[str]) -> tuple[dict[str, PlaceInTest], list[str]]:
    found: dict[str, PlaceInTest] = {}
    without: list[str] = []
    for test in tests:
        place = place_of(project, test)
        if place is None:
            without.append(test)
        else:
            found[test] = place
    return found, without


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
    return sorted(chosen, key=lambda one: -len(_kills(one, proof.kills)))


def chosen_of(
    checks: Sequence[ProposedCheck], kills: Mapping[ProposedCheck, Mapping[str, Sequence[int]]]
) -> list[ProposedCheck]:
    """For all that any check kills, the one that a person would rather write; none that others replace."""
    left = frozenset().union(*(_kills(one, kills) for one in checks))
    chosen: list[ProposedCheck] = []
    for one in sorted(checks, key=lambda one: (one.worth, len(_kills(one, kills))), reverse=True):
        if _kills(one, kills) & left:
            chosen.append(one)
            left -= _kills(one, kills)
    for one in list(chosen):
        others = [other for other in chosen if other is not one]
        if _kills(one, kills) <= frozenset().union(*(_kills(other, kills) for other in others)):
            chosen = others
    return chosen


def _kills(
    check: ProposedCheck, kills: Mapping[ProposedCheck, Mapping[str, Sequence[int]]]
) -> frozenset[tuple[str, int]]:
    """What a check kills, as far as it was run; else what it would by what was measured."""
    if check not in kills:
        return check.trials
    return frozenset((mutant, round) for mutant, rounds in kills[check].items() for round in rounds)


def _suggestion(check: ProposedCheck, kills: Mapping[str, tuple[int, ...]], seeds: int) -> Suggestion:
    added = check.addition()
    is_other = check.place.style == OTHER
    return Suggestion(
        test=check.place.node,
        style=check.place.style,
        looks_at=check.reading.text,
        statement=check.statement,
        by_hand="\n".join([*dict.fromkeys(added.imports), *added.lines]) if is_other else "",
        tolerance=check.tolerance,
        spread=check.band.spread if check.band is not None else None,
        runs=check.runs,
        fresh=seeds,
        unseen=unseen(seeds),
        kills=kills,
    )
