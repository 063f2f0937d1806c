"""Find checks that kill the survivors of a campaign.

Which survivors an observation can kill, which none can, and why no check kills one that it could.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from mutabot.api.processes import Request
from mutabot.api.reports import (
    CampaignRun,
    MutabotError,
    MutantResult,
    Progress,
    Results,
    Verdict,
)

from .checks import ProposedCheck, Trials, candidates, clock_text, is_clock, unseen
from .found import Dropped, NothingToSuggestError, ProvenCheck, Suggestions, Unsolved
from .project import OTHER, PlaceInTest, SuiteFiles, copy_of, edited, place_of
from .readings import Measured, is_number, known, measure

#: how often checks are chosen anew because one of them failed its proof
_ATTEMPTS = 5


def _sorted_out(
    chosen: Sequence[MutantResult],
) -> tuple[dict[str, tuple[MutantResult, list[int]]], list[Unsolved], list[str]]:
    """The survivors that may look other than the original, the others, and the tests where the first acted.

    The first by id, with the rounds in which they survived. No check at the ends of these tests can kill the
    others.
    """
    to_kill: dict[str, tuple[MutantResult, list[int]]] = {}
    never: list[Unsolved] = []
    tests: dict[str, None] = {}
    for one in chosen:
        different = [out for out in one.survived if out.indistinguishable is not True]
        reason = "no test reaches it; add a test that does"
        if different:
            to_kill[one.mutant.id] = one, [out.round for out in different]
            tests.update({looked.test: None for out in different for looked in out.looked if looked.acted})
            continue
        if one.survived:
            compared = one.survived[0].compared
            extent = f" in {compared.text}" if compared is not None else " that was compared"
            reason = f"nothing differs{extent} (indistinguishable)"
        never.append(Unsolved(one.mutant.id, reason, never=True))
    return to_kill, never, list(tests)


def why_unsolved(
    mutant: str,
    measured: Measured,
    found: Sequence[ProposedCheck],
    proof: Proof,
    refused: Mapping[str, str],
) -> Unsolved:
    """The reason for a mutant, by its id, with what differs most and how far the original itself spreads."""
    failed = [one for one in found if one in proof.failed and mutant in dict(one.trials)]
    if failed:
        return Unsolved(mutant, f"a check that would notice it failed its proof: {failed[0].statement}")
    if mutant in refused:
        return Unsolved(mutant, refused[mutant])
    nothing = "nothing differs in what its tests can read at their ends"
    return Unsolved(mutant, max(_differences(mutant, measured), default=(0.0, nothing))[1])


def _differences(mutant: str, measured: Measured) -> list[tuple[float, str]]:
    """Describe how far readings are from the original's, in units of its own spread."""
    found = []
    for place, by_mutant in measured.mutants.items():
        originals = measured.originals.get(place, {})
        for key, read in by_mutant.get(mutant, {}).items():
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
                deviation = apart / max(spread, tolerance)
                found.append((0.0, clock_text(text)) if is_clock(text) else (deviation, words))
    return found


def _short(value: float) -> str:
    return repr(float(f"{value:.3g}"))


class Quiet:
    """Progress without the remarks of campaigns that only serve."""

    left: float | None = None

    def __init__(self, progress: Progress) -> None:
        self.stage, self.advance = progress.stage, progress.advance
        self.mutant_ended = progress.mutant_ended

    def note(self, text: str) -> None:
        """Print nothing: the campaign itself has printed the note."""


def suggest(
    request: Request, chosen: Sequence[MutantResult], progress: Progress, *, seeds: int
) -> Suggestions:
    """Suggest checks that kill these survivors of a finished campaign.

    Args:
        request: as the campaign's was.
        chosen: the survivors that are to be killed.
        progress: is told.
        seeds: how many fresh seeds are run for the bands, and as many others for the proof.

    Raises NothingToSuggestError if there is nothing to kill or to look at, and what a campaign raises.
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
    project = SuiteFiles(request)
    places = {test: place for test in tests if (place := place_of(project, test)) is not None}
    if not places:
        raise NothingToSuggestError(
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
    left = [mutant for mutant in to_kill if mutant not in killed]
    return replace(
        nothing,
        checks=tuple(_suggestion(one, proof.kills[one], seeds) for one in checks),
        diff=project.diff(texts),
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
    for one in chosen[::-1]:  # the best is the last to go
        others = [other for other in chosen if other is not one]
        if trials[one] <= frozenset().union(*(trials[other] for other in others)):
            chosen = others
    return chosen


def _suggestion(check: ProposedCheck, trials: Trials, seeds: int) -> ProvenCheck:
    added = check.addition()
    is_other = check.place.style == OTHER
    kills: dict[str, tuple[int, ...]] = {}
    for mutant, round in sorted(trials):
        kills[mutant] = (*kills.get(mutant, ()), round)
    return ProvenCheck(
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


@dataclass(slots=True)
class Proof:
    """The results of proving checks, by their statements and tests.

    Attributes:
        request: for the rounds of the campaign.
        project: into whose tests checks are put.
        progress: is told.
        failed: checks that failed, with the reason.
        kills: of each check that was run on the survivors: the mutants and rounds that it killed.
    """

    request: Request
    project: SuiteFiles
    progress: Progress
    failed: dict[ProposedCheck, str] = field(default_factory=dict)
    kills: dict[ProposedCheck, Trials] = field(default_factory=dict)

    def on_original(self, checks: Sequence[ProposedCheck], rounds: Sequence[int]) -> list[ProposedCheck]:
        """Return the checks with which the original passes in all of these rounds."""
        left = [one for one in checks if one not in self.failed]
        while left:
            alarms = self._alarms(left, rounds)
            if not alarms:
                return left
            self.failed.update(alarms)
            left = [one for one in left if one not in alarms]
        return []

    def _alarms(self, checks: Sequence[ProposedCheck], rounds: Sequence[int]) -> dict[ProposedCheck, str]:
        texts = texts_with(self.project, checks)
        found: dict[ProposedCheck, str] = {}
        with copy_of(self.request, texts) as copied:
            these = _only(copied, checks)
            self.progress.stage("proof on the original", len(rounds))
            with CampaignRun.of_original(these, rounds, self.progress) as results:
                for result in results:
                    self.progress.advance(f"round {result.task.key + 1}")
                    where = f"round {result.task.key + 1} of the original"
                    if result.end is None or result.end.errors or not result.ends:
                        why = result.death() if result.end is None else "; ".join(result.end.errors)
                        return dict.fromkeys(checks, f"the tests cannot be run with it: {why or 'none ran'}")
                    for end in result.ends:
                        if end.outcome == "failed":
                            text = f"fails in {where}: {(end.message or 'no message').splitlines()[0]}"
                            for one in _blamed(checks, end.test, end.place or "", texts):
                                found.setdefault(one, text)
        return found

    def on_survivors(
        self, checks: Sequence[ProposedCheck], mutants: Mapping[PlaceInTest, Iterable[str]]
    ) -> None:
        """Run campaigns of the mutants that act in the tests of these checks, by the tests.

        A test has one of the checks at a time; those of several tests are run together.
        """
        left = [one for one in checks if one not in self.kills and one not in self.failed]
        while left:
            batch = list({_own_name(one.place.node): one for one in reversed(left)}.values())
            left = [one for one in left if one not in batch]
            try:
                self._run(batch, mutants)
            except MutabotError as error:
                if len(batch) > 1:
                    for one in batch:
                        self.on_survivors([one], mutants)
                else:
                    self.failed[batch[0]] = f"a campaign with it ends: {str(error).splitlines()[0]}"

    def _run(self, checks: Sequence[ProposedCheck], mutants: Mapping[PlaceInTest, Iterable[str]]) -> None:
        only = tuple(dict.fromkeys(mutant for one in checks for mutant in mutants[one.place]))
        with copy_of(self.request, texts_with(self.project, checks)) as copied:
            these = _only(copied, checks)
            path = CampaignRun.to_end(
                replace(these, only=only, every_test=True, repeats=False), self.progress
            )
            outcomes = Results.read(path).outcomes
        killed: dict[str, set[tuple[str, int]]] = {}
        for outcome in outcomes:
            for kill in outcome.kills if outcome.verdict is Verdict.KILLED else ():
                if kill.by == "check":
                    killed.setdefault(_own_name(kill.test), set()).add((outcome.mutant, outcome.round))
        for one in checks:
            self.kills[one] = frozenset(killed.get(_own_name(one.place.node), ()))
            if not self.kills[one]:
                self.failed[one] = "kills no survivor when it is run"


def _own_name(node: str) -> str:
    """The name of a test within its file or class, without parameters."""
    return node.partition("[")[0].rpartition("::")[2]


def texts_with(project: SuiteFiles, checks: Sequence[ProposedCheck]) -> dict[str, str]:
    """The texts of the files that change when checks stand at the ends of their tests, by path."""
    return edited(project, (one.addition() for one in checks))


def _only(request: Request, checks: Sequence[ProposedCheck]) -> Request:
    tests = tuple(dict.fromkeys(one.place.node for one in checks))
    return request.changed(tests=tests)


def _blamed(
    checks: Sequence[ProposedCheck], test: str, place: str, texts: Mapping[str, str]
) -> list[ProposedCheck]:
    """The checks that let a test fail: that at the place, ``file:line``, else all of the test."""
    file, _, line = place.rpartition(":")
    lines = texts.get(file, "").splitlines()
    if line.isdigit() and 0 < int(line) <= len(lines):
        found = [one for one in checks if one.statement == lines[int(line) - 1].strip()]
        if found:
            return found
    node = test.partition("[")[0]
    return [one for one in checks if one.place.node == node] or list(checks)
