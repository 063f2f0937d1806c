"""The whole way from a campaign's survivors to checks that kill them.

Which survivors an observation can kill, which none can, and why no check kills one that it could.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from math import comb
from typing import TypeVar

from mutabot.campaign.request import Progress, Request
from mutabot.errors import NothingToDoError
from mutabot.frozen import frozen
from mutabot.model import Mutant
from mutabot.results.results import MutantResult, Results
from mutabot.results.suggested import Dropped, Suggestion, Suggestions, Unsolved

from .candidates import candidates, part_of_way, tolerance_of
from .checks import Check, decimal, is_number, unseen
from .measure import Measured, measure
from .project import Project, diff_of
from .prove import Proof, texts_with
from .readings import WAY, fixture
from .style import OTHER, Place, place_of


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


#: how often the smallest set is looked for anew because a check of it failed its proof
_ATTEMPTS = 5


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
            "the vocabulary names no probe: only what the oracle reads and what tests have at hand "
            "can be looked at; a [[probe]] shows more"
        )
    elif not survivors.to_kill:
        progress.note("nothing that was compared differs in any survivor: a further [[probe]] may show more")
    if not survivors.to_kill:
        return _told(Suggestions(unsolved=survivors.never), chosen, request, seeds)
    quiet = Quiet(progress)
    project = Project(request)
    places, without = _places(project, survivors.tests)
    if not places:
        shown = next(iter(without), "no test")
        raise NothingToDoError(
            f"no check can be added to the tests of these survivors, such as {shown}: they are "
            "neither functions of pytest, nor methods of unittest, nor made of scenarios"
        )
    calibrated = request.rounds + seeds
    measured = measure(
        replace(request, rounds=calibrated), project, places,
        [(one.mutant, rounds) for one, rounds in survivors.to_kill], quiet,
    )  # fmt: skip
    found = candidates(project, measured)
    proof = Proof(request, project, quiet)
    fresh = range(calibrated, calibrated + seeds)
    chosen_checks = _proven(proof, found, measured, [*range(request.rounds), *fresh])
    texts = texts_with(project, [one for one in chosen_checks if one.place.style != OTHER])
    suggestions = tuple(_suggestion(one, proof.kills[one], seeds) for one in chosen_checks)
    killed = {mutant for one in suggestions for mutant in one.kills}
    left = [one.mutant for one, _ in survivors.to_kill if one.mutant.id not in killed]
    unsolved = [*(why_unsolved(one, measured, found, proof) for one in left), *survivors.never]
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


def _places(project: Project, tests: Sequence[str]) -> tuple[dict[str, Place], list[str]]:
    found: dict[str, Place] = {}
    without: list[str] = []
    for test in tests:
        place = place_of(project, test)
        if place is None:
            without.append(test)
        else:
            found[test] = place
    return found, without


def _proven(proof: Proof, found: Sequence[Check], measured: Measured, rounds: Sequence[int]) -> list[Check]:
    """The smallest set of checks that all stand their proof; largest kills first."""
    mutants = {place: list(found) for place, found in measured.mutants.items()}
    chosen: list[Check] = []
    for _ in range(_ATTEMPTS):
        left = [one for one in found if one not in proof.failed]
        chosen = smallest_cover(left, lambda one: _noticed(one, proof), _worth)
        new = [one for one in chosen if one not in proof.kills]
        if not new:
            break
        passing = proof.on_original(chosen, rounds)
        proof.on_survivors(passing, mutants)
    chosen = [one for one in chosen if one in proof.kills and one not in proof.failed]
    return sorted(chosen, key=lambda one: -len(_noticed(one, proof)))


def _noticed(check: Check, proof: Proof) -> frozenset[tuple[str, int]]:
    """What a check kills, as far as it was run; else what it would by what was measured."""
    kills: Mapping[str, Sequence[int]] | None = proof.kills.get(check)
    if kills is None:
        return check.trials
    return frozenset((mutant, round) for mutant, rounds in kills.items() for round in rounds)


def _worth(check: Check) -> float:
    """Of checks that notice the same: the way in which the tests read already, plain, far from the band."""
    expected = check.expected
    beside = 4.0 * (expected.label is not None) + 5.0 * (expected.minus is not None)
    effort = 10.0 * check.reading.way + beside
    return min(math.log10(max(check.margin, 1.0)), 3.0) - effort - 0.01 * len(check.statement)


def _suggestion(check: Check, kills: Mapping[str, tuple[int, ...]], seeds: int) -> Suggestion:
    expected, band = check.expected, check.expected.band
    return Suggestion(
        test=check.place.node,
        style=check.place.style,
        moment="at any moment" if check.reading.way == WAY else "end of the test",
        looks_at=check.looked_at,
        statement=check.statement,
        by_hand=_by_hand(check),
        tolerance=band.tolerance if band is not None else None,
        band=band.kind if band is not None else "always the same",
        factor=band.factor if band is not None else None,
        spread=band.spread if band is not None else None,
        runs=expected.runs,
        alarm=band.alarm if band is not None else unseen(expected.runs),
        fresh=seeds,
        unseen=unseen(seeds),
        kills=kills,
    )


def _by_hand(check: Check) -> str:
    """All that is to be added to a test that another tool makes; empty for one in which the diff has it."""
    added = check.addition()
    if added.place.style != OTHER:
        return ""
    watch = fixture(added.watch, for_all=True) if added.watch is not None else []
    return "\n".join([*dict.fromkeys(added.imports), *watch, *added.lines])


C = TypeVar("C")
#: sets of checks that are looked through one by one; above it, the best is taken again and again
_SETS = 50_000


def smallest_cover(
    checks: Sequence[C], noticed: Callable[[C], frozenset[Hashable]], worth: Callable[[C], float]
) -> list[C]:
    """As few checks as possible that notice what all notice; of equal sets the one worth most.

    The fewest where that many sets can be looked through, else those that a greedy choice finds.
    """
    useful = _undominated([one for one in checks if noticed(one)], noticed, worth)
    whole: frozenset[Hashable] = frozenset().union(*map(noticed, useful)) if useful else frozenset()
    greedy = _greedy(useful, noticed, worth, whole)
    for size in range(1, len(greedy) + 1):
        if comb(len(useful), size) > _SETS:
            break
        fitting = [
            some for some in combinations(useful, size) if frozenset().union(*map(noticed, some)) == whole
        ]
        if fitting:
            return list(max(fitting, key=lambda some: sum(map(worth, some))))
    return greedy


def _undominated(
    checks: Sequence[C], noticed: Callable[[C], frozenset[Hashable]], worth: Callable[[C], float]
) -> list[C]:
    """Without those that another one can stand for: it notices more, or the same and is worth more."""
    ordered = sorted(checks, key=lambda one: (-len(noticed(one)), -worth(one)))
    kept: list[C] = []
    for one in ordered:
        if not any(noticed(one) <= noticed(other) for other in kept):
            kept.append(one)
    return kept


def _greedy(
    checks: Sequence[C],
    noticed: Callable[[C], frozenset[Hashable]],
    worth: Callable[[C], float],
    whole: frozenset[Hashable],
) -> list[C]:
    left, found = set(whole), []
    while left:
        best = max(checks, key=lambda one: (len(noticed(one) & left), worth(one)))
        found.append(best)
        left -= noticed(best)
    for one in list(found):
        others = [other for other in found if other is not one]
        if frozenset().union(*map(noticed, others)) == whole:
            found = others
    return found
