"""The results of a campaign, read from a journal once, for all reports."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, fields, replace
from pathlib import Path
from typing import Any

from mutabot.errors import (
    SelectionError,
    UsageError,
    in_short,
    nearest_name,
    plural,
    shortened,
    unknown_name_text,
)
from mutabot.frozen import frozen
from mutabot.journal import records
from mutabot.journal.files import is_written
from mutabot.journal.reader import JournalReader
from mutabot.model import By, LeftOut, Mutant, Outcome, Quantity, Role, Verdict
from mutabot.model.mutant_pattern import fits
from mutabot.model.selection import select
from mutabot.model.suppression import Acceptance, Accepted
from mutabot.results.divergence import change_text, explain, quantity_of, weight_of
from mutabot.results.score import Group, RoundScores, Score, groups_of
from mutabot.results.statistics import Confirmed

#: mutants that are named where a text fits several
_SHOWN = 10
#: verdicts outside the score, those first that most need a look; of several rounds the first names the state
OUTSIDE = (
    Verdict.ERROR, Verdict.UNSTABLE, Verdict.REFUSED, Verdict.GUARDED, Verdict.INVALID, Verdict.NO_EFFECT,
)  # fmt: skip


@frozen
class MutantResult:
    """The result of one mutant.

    Attributes:
        mutant: the mutant.
        rounds: its outcome in each round; None where it has not been run.
        quantity: what it changes, if the journal holds the vocabulary.
        why: one line about how it ended.
        earlier: whether an earlier campaign found some of it.
        outdated: whether something has changed since that it depends on, as far as that is known.
        acceptance: why it is accepted if it survives; None if it is not.
    """

    mutant: Mutant
    rounds: tuple[Outcome | None, ...]
    quantity: Quantity | None
    why: str
    earlier: bool = False
    outdated: bool = False
    acceptance: Acceptance | None = None

    def __repr__(self) -> str:
        state = "accepted" if self.is_accepted else self.status or "not run"
        mutant = self.mutant
        return f"<mutant {mutant.number}, {state}: {mutant.site.span.place} {mutant.description}>"

    @property
    def outcomes(self) -> tuple[Outcome, ...]:
        """The outcomes in rounds that were run."""
        return tuple(outcome for outcome in self.rounds if outcome is not None)

    @property
    def survived(self) -> list[Outcome]:
        """The outcomes in which every test that reaches the mutant passed."""
        return [outcome for outcome in self.outcomes if outcome.verdict is Verdict.SURVIVED]

    @property
    def kill_rate(self) -> Score:
        """The share of rounds that killed it."""
        return Score.of(self.outcomes)

    @property
    def lets_through(self) -> bool:
        """Whether it survives in any round, or no test reaches it there."""
        return any(map(_lets_through, self.outcomes))

    @property
    def is_survivor(self) -> bool:
        """Whether it survives in any round, or no test reaches it there, and it is not accepted."""
        return self.lets_through and self.acceptance is None

    @property
    def is_accepted(self) -> bool:
        """Whether it survives in any round and is accepted, so that it is in no score."""
        return self.lets_through and self.acceptance is not None

    @property
    def status(self) -> Verdict | None:
        """The verdict over all rounds, also of an accepted survivor; None if it has not been run.

        - *survived* if it survives in any round: that is what there is to act on;
        - *not covered* if no test reaches it in some round;
        - *killed* if every round in which it is valid kills it, *timeout* if all these only ran out of
          budget;
        - else, as no round was valid, the verdict outside the score that most needs a look.
        """
        found = {outcome.verdict for outcome in self.outcomes}
        valid = {verdict for verdict in found if verdict.is_valid}
        for lets_through in (Verdict.SURVIVED, Verdict.NOT_COVERED):
            if lets_through in valid:
                return lets_through
        if valid:
            return Verdict.TIMEOUT if valid == {Verdict.TIMEOUT} else Verdict.KILLED
        return next((verdict for verdict in OUTSIDE if verdict in found), None)

    @property
    def deviation(self) -> float:
        """The greatest distance of its survivors from the original, in units of the original's spread."""
        return max((outcome.deviation or 0.0 for outcome in self.survived), default=0.0)

    @property
    def change(self) -> str | None:
        """Describe its first change, in the test whose story is reported; None if not known."""
        outcomes = sorted(self.survived, key=weight_of, reverse=True) or self.outcomes
        return next(
            filter(None, (change_text(self.mutant, outcome, self.quantity) for outcome in outcomes)), None
        )

    @property
    def indistinguishable(self) -> bool:
        """Whether all its survivors looked exactly like the original."""
        return bool(self.survived) and all(outcome.indistinguishable for outcome in self.survived)

    @property
    def is_unmeasured(self) -> bool:
        """Whether calls of the robot may end differently, and neither a probe nor a recording shows how."""
        if any(outcome.deviation is not None or outcome.diverged for outcome in self.survived):
            return False
        calls = sum(outcome.compared.calls for outcome in self.survived if outcome.compared is not None)
        return bool(self.mutant.operation) or calls > 0


@frozen
class Results:
    """The results of a campaign.

    Attributes:
        meta: what the campaign said about itself.
        state: ``complete``, ``incomplete`` (all has run, but the journal lacks some of it), ``interrupted``,
            ``running``, ``killed`` or why it stopped; of a shard, which.
        rounds: number of rounds.
        mutants: every planned mutant by number, but for graded ones.
        groups: scores per family and role.
        all: scores of all mutants together, as published studies give them. Only to be shown beside
            ``groups``, because it mixes roles.
        left_out: what the plan leaves out.
        controls: the control mutants.
        baseline: its tests on the original.
        verification: what ``--verify`` found; None if it was not asked for.
        repeats: how many outcomes were run once more, and how many ended otherwise.
        flaky: tests that cannot be relied on.
        drawing: how the mutants were drawn from those selected; None if they are all.
        drawn: scores of those drawn, per family and role.
        attempt: why a later campaign ended before it ran anything; None if there was none.
        graded: the mutants of family ``graded``, by number. The magnitudes of a ladder are no population of
            faults, and most of them need not be run: no score and no list of survivors knows of them.
        since: what was run of what has changed since a revision; None if that was not asked for.
        budget: how limited time was used; None if it was not limited.
        shard: which part of its plan the campaign has run; None for all of it.
        set_aside: descriptions of what the journal holds that Mutabot has not written or that cannot be.
            Nothing of it is believed: its outcomes count as not run.
        sources: text of the mutated files at the time of the campaign, by path relative to the project.
        operators: what each operator does, in a sentence, by its name; those of journals that do not say it
            are missing.
        reaching: which tests reach which sites.
        draws: names of operators that draw a number for each round.
        untested: what no test reaches of the program.
        accepting: what is known of accepted survivors.
    """

    meta: Mapping[str, Any]
    state: str
    rounds: int
    mutants: tuple[MutantResult, ...]
    groups: tuple[Group, ...]
    all: RoundScores
    left_out: tuple[LeftOut, ...]
    controls: tuple[records.ControlEnd, ...]
    baseline: tuple[records.BaselineTest, ...]
    verification: records.Verification | None = None
    repeats: records.Repeats = field(default_factory=records.Repeats)
    flaky: records.Flaky = field(default_factory=records.Flaky)
    drawing: records.Drawing | None = None
    drawn: tuple[Group, ...] = ()
    attempt: str | None = None
    graded: tuple[MutantResult, ...] = ()
    since: records.Since | None = None
    budget: records.Budgeted | None = None
    shard: records.ShardOf | None = None
    set_aside: tuple[str, ...] = ()
    sources: Mapping[str, str] = field(default_factory=dict)
    operators: Mapping[str, str] = field(default_factory=dict)
    reaching: records.Reaching = field(default_factory=records.Reaching)
    draws: tuple[str, ...] = ()
    untested: records.Untested = field(default_factory=records.Untested)
    accepting: Accepted = field(default_factory=Accepted)

    @property
    def altered(self) -> tuple[str, ...]:
        """Descriptions of changes by other processes to the running campaign's journal, which were undone."""
        return tuple(self.meta.get(records.ALTERED) or ())

    @property
    def selected_of(self) -> int | None:
        """The number of mutants from which ``--only`` and ``--skip`` selected these; None if they are all."""
        of = self.meta.get(records.SELECTED_OF)
        return of if of is not None and of > len(self.mutants) else None

    @property
    def is_complete(self) -> bool:
        """Whether the campaign ran to its end."""
        return self.state == "complete"

    @property
    def bugs_caught(self) -> list[str]:
        """What suites with such scores caught of real bugs; empty where only some mutants were run."""
        if not self.is_complete or self.since is not None or self.selected_of is not None:
            return []
        return [text for group in self.groups if (text := group.bugs_caught) is not None]

    @property
    def everything(self) -> tuple[MutantResult, ...]:
        """All mutants, graded ones included, by number."""
        if not self.graded:
            return self.mutants
        return tuple(sorted((*self.mutants, *self.graded), key=lambda result: result.mutant.number))

    @property
    def outcomes(self) -> tuple[Outcome, ...]:
        """All outcomes: by mutant, then by round."""
        return tuple(outcome for result in self.everything for outcome in result.outcomes)

    @property
    def tests(self) -> list[str]:
        """Node ids of all known tests, including those that mutants name."""
        named = (test for outcome in self.outcomes for test, _ in killing_tests(outcome))
        baseline = (row.test.test for row in self.baseline)
        return list(dict.fromkeys([*baseline, *self.reaching.tests, *named]))

    @classmethod
    def read(cls, path: Path, *, earlier: bool = False) -> Results:
        """Read the last campaign of the journal at a path, and earlier ones if ``earlier``.

        Raises JournalError.
        """
        with JournalReader.open(path) as journal:
            return read_results(journal, earlier=earlier)

    def mutant(self, name: str) -> MutantResult:
        """Return the mutant with this number or id, or the only one that matches ``name`` as in ``--only``.

        A part of an id will do. Raises SelectionError, naming the nearest id, or the mutants that it fits.
        """
        everything = self.everything
        for result in everything:
            if name in (result.mutant.id, str(result.mutant.number)):
                return result
        if not everything:
            raise SelectionError("the journal holds no mutants")
        if name.isdigit():
            first, last = everything[0].mutant.number, everything[-1].mutant.number
            many = plural(len(everything), "mutant")
            raise SelectionError(
                f"the last campaign has no mutant {name}: its {many} are between {first} and {last}, "
                "and `mutabot list` numbers all that there are"
            )
        found = [
            candidate
            for candidate in everything
            if name in candidate.mutant.id or fits(name, candidate.mutant)
        ]
        if len(found) == 1:
            return found[0]
        if found:
            raise SelectionError(_several(name, found))
        ids = [candidate.mutant.id for candidate in everything]
        if nearest_name(name, ids) is None:  # a list of ids would be of no help
            known = f"numbers 1 to {everything[-1].mutant.number}, ids, or parts of ids such as {ids[0]!r}"
            raise SelectionError(f"there is no mutant {shortened(name)!r}; give {known}")
        raise SelectionError(unknown_name_text("mutant", name, ids))

    def selected(self, only: Iterable[str], skip: Iterable[str]) -> list[MutantResult]:
        """Return the ``mutants`` that match ``only`` and not ``skip``. Raises SelectionError."""
        chosen = {mutant.id for mutant in select([result.mutant for result in self.mutants], only, skip)}
        return [result for result in self.mutants if result.mutant.id in chosen]

    def round_index(self, number: int) -> int:
        """Return the 0-based index of the round with this number. Raises UsageError if there is none."""
        if number > self.rounds:
            raise UsageError(f"there is no round {number}; the campaign has {self.rounds}")
        return number - 1

    def source(self, file: str) -> str | None:
        """Return the text of a mutated file at the time of the campaign; None if it was not recorded."""
        return self.sources.get(file)

    def reached_by(self, mutant: Mutant) -> tuple[str, ...]:
        """Return node ids of the tests that reach a mutant in any round, according to the journal."""
        return self.reaching.at(mutant.site.id)

    @property
    def ladders(self) -> int:
        """Number of ladders of graded mutants."""
        return len({result.mutant.ladder for result in self.graded})

    @property
    def earlier(self) -> list[MutantResult]:
        """Mutants with outcomes of an earlier campaign."""
        return [result for result in self.mutants if result.earlier]

    @property
    def survivors(self) -> list[MutantResult]:
        """Mutants that survive in some round, the farthest from the original at any moment first.

        Of those without a deviation, first those with a known difference, last the indistinguishable ones.
        """

        def rank(result: MutantResult) -> tuple[float, bool, bool, int]:
            is_known = any(outcome.divergence for outcome in result.survived)
            return -result.deviation, result.indistinguishable, not is_known, result.mutant.number

        return sorted((result for result in self.mutants if result.is_survivor), key=rank)

    @property
    def accepted(self) -> list[MutantResult]:
        """Survivors that are accepted, by number."""
        return [result for result in self.mutants if result.is_accepted]

    @property
    def needlessly_accepted(self) -> list[str]:
        """Descriptions of decisions whose mutants are all killed in every valid round."""
        groups: dict[str, list[MutantResult]] = {}
        for result in self.mutants:
            if result.acceptance is not None:
                groups.setdefault(result.acceptance.source, []).append(result)
        return [_killed_now_text(source, those) for source, those in groups.items() if _is_killed(those)]

    @property
    def worst_first(self) -> list[MutantResult]:
        """The survivors in that order, then all others by number."""
        survivors = self.survivors
        return [*survivors, *(result for result in self.mutants if not result.is_survivor)]

    def with_verdict(self, *verdicts: Verdict) -> list[tuple[MutantResult, Outcome]]:
        """Return each mutant with its first outcome of one of these verdicts, by number."""
        found = []
        for result in self.mutants:
            outcome = next(
                (candidate for candidate in result.outcomes if candidate.verdict in verdicts), None
            )
            if outcome is not None:
                found.append((result, outcome))
        return found

    @property
    def planned(self) -> int:
        """Number of (mutant, round) pairs that the campaign was to run, without graded mutants."""
        return len(self.mutants) * self.rounds

    @property
    def confirmation(self) -> Confirmed | None:
        """The whole suite's verdicts on mutants that ran without some tests; None if none did."""
        return Confirmed.of(self.outcomes, self.meta.get("seed") or 0)

    @property
    def known(self) -> str:
        """The known outcomes as text: ``12 of 20 outcomes are known``."""
        return (
            f"{self.done} of {plural(self.planned, 'outcome')} {'is' if self.planned == 1 else 'are'} known"
        )

    @property
    def done(self) -> int:
        """Number of (mutant, round) pairs that have an outcome."""
        return sum(len(result.outcomes) for result in self.mutants)


def killing_tests(outcome: Outcome) -> list[tuple[str, By | None]]:
    """Return the known tests that noticed a mutant, and what noticed it."""
    if not outcome.verdict.is_killed:
        return []
    first = [(outcome.test, outcome.by)] if outcome.test is not None else []
    return [*first, *((kill.test, kill.by) for kill in outcome.kills)]


def _several(name: str, found: Sequence[MutantResult]) -> str:
    lines = [f"{result.mutant.number:>6}  {result.mutant.id}" for result in found[:_SHOWN]]
    more = [f"        and {len(found) - _SHOWN} more"] if len(found) > _SHOWN else []
    return "\n".join([f"{name!r} fits {len(found)} mutants; give a number or a whole id:", *lines, *more])


#: what a campaign says about itself under the name that it has in ``Results``
_READ = {field.name for field in fields(Results)} & (records.FACTS.keys() - records.PLAIN.keys())


def read_results(journal: JournalReader, *, earlier: bool = False) -> Results:
    """Read what the journal holds now: the last campaign, and earlier ones if ``earlier``."""
    meta, mutants = journal.meta(), journal.mutants()
    planned = {mutant.id for mutant in mutants}
    outcomes = [outcome for outcome in journal.outcomes() if outcome.mutant in planned]
    rounds = _number_of_rounds(meta, outcomes)
    outcomes = [outcome for outcome in outcomes if outcome.round < rounds]
    vocabulary = journal.vocabulary
    facts = {key: meta[key] for key in _READ if key in meta}
    accepting: Accepted = meta.get(records.ACCEPTED) or Accepted()
    drawing, shard = facts.get(records.DRAWING), facts.get(records.SHARD)
    accepted = _accepted(accepting, outcomes)
    groups = groups_of(mutants, outcomes, rounds, drawing, accepted=accepted)
    is_whole = _is_whole(mutants, outcomes, rounds)
    drawn = groups if drawing is not None else ()
    old, outdated = _earlier(journal, mutants, outcomes, rounds) if earlier else ([], {})
    old_ids = {outcome.mutant for outcome in old}
    if old:
        more = [mutant for mutant, _ in journal.known() if mutant.id in old_ids]
        mutants = sorted([*mutants, *more], key=lambda mutant: mutant.number)
        outcomes = [*outcomes, *old]
        accepted = _accepted(accepting, outcomes)
        groups = groups_of(mutants, outcomes, rounds, None, accepted=accepted)
    graded = {mutant.id for mutant in mutants if mutant.has_sizes}
    by_place = {(outcome.mutant, outcome.round): outcome for outcome in outcomes}

    def result(mutant: Mutant) -> MutantResult:
        row = tuple(by_place.get((mutant.id, number)) for number in range(rounds))
        why = explain(mutant, [outcome for outcome in row if outcome is not None], vocabulary)
        quantity = quantity_of(mutant, vocabulary)
        return MutantResult(
            mutant, row, quantity, why, mutant.id in old_ids, outdated.get(mutant.id, False),
            None if mutant.has_sizes else accepting.mutants.get(mutant.id),
        )  # fmt: skip

    files = sorted({span.file for mutant in mutants for span in mutant.site.spans})
    texts = {file: journal.source(file) for file in files}
    found = Results(
        meta=meta,
        state="",
        rounds=rounds,
        mutants=tuple(result(mutant) for mutant in mutants if mutant.id not in graded),
        graded=tuple(result(mutant) for mutant in mutants if mutant.id in graded),
        groups=groups,
        all=RoundScores.of(
            [outcome for outcome in outcomes if outcome.mutant not in graded], rounds, accepted=accepted
        ),
        left_out=tuple(journal.left_out()),
        controls=tuple(journal.controls()),
        baseline=tuple(journal.tests()),
        drawn=drawn,
        attempt=_attempt(journal),
        accepting=accepting,
        sources={file: text for file, text in texts.items() if text is not None},
        **facts,
    )
    # what rows hold is known now that they are read
    set_aside = tuple(journal.set_aside)
    state = _state(journal, shard, is_whole=is_whole and not set_aside)
    return replace(found, state=state, set_aside=set_aside)


def _lets_through(outcome: Outcome) -> bool:
    return outcome.verdict.is_valid and not outcome.verdict.is_killed


def _is_killed(results: Iterable[MutantResult]) -> bool:
    """Return whether all of these have run in every round, and every valid round of each kills it."""
    return all(
        result.kill_rate.valid and not result.lets_through and None not in result.rounds for result in results
    )


def _killed_now_text(source: str, results: Sequence[MutantResult]) -> str:
    numbers = in_short([str(result.mutant.number) for result in results], _SHOWN)
    is_one = len(results) == 1
    return (
        f"{source}: mutant{'' if is_one else 's'} {numbers} {'is' if is_one else 'are'} killed now, so there "
        "is nothing to accept"
    )


def _accepted(accepting: Accepted, outcomes: Iterable[Outcome]) -> set[str]:
    """Return the ids of accepted mutants that survive in some round."""
    return {
        outcome.mutant
        for outcome in outcomes
        if outcome.mutant in accepting.mutants and _lets_through(outcome)
    }


def _earlier(
    journal: JournalReader, planned: Sequence[Mutant], outcomes: Sequence[Outcome], rounds: int
) -> tuple[list[Outcome], dict[str, bool]]:
    """Return outcomes of earlier campaigns that the last one lacks, of its mutants or others.

    Also of which mutants of these something has changed since that they depend on, by their ids.
    """
    done = {(outcome.mutant, outcome.round) for outcome in outcomes}
    outdated = {mutant.id: is_outdated for mutant, is_outdated in journal.known()}
    wanted = {mutant.id for mutant in planned} | outdated.keys()
    found = [
        outcome
        for outcome in journal.kept_outcomes()
        if outcome.mutant in wanted and outcome.round < rounds and (outcome.mutant, outcome.round) not in done
    ]
    # what was planned and would still hold has been taken over, unless everything is to be run again, or
    # another shard is to look at it
    meta = journal.meta()
    may_hold = bool(meta.get("fresh")) or records.SHARD in meta
    return found, {outcome.mutant: outdated.get(outcome.mutant, not may_hold) for outcome in found}


def _number_of_rounds(meta: Mapping[str, Any], outcomes: list[Outcome]) -> int:
    rounds = meta.get("rounds")
    return rounds if isinstance(rounds, int) else max((outcome.round + 1 for outcome in outcomes), default=0)


def _attempt(journal: JournalReader) -> str | None:
    found = journal.attempt
    return found if found or found is None else _unfinished(journal)


def _unfinished(journal: JournalReader) -> str:
    return "running" if is_written(journal.path) else "killed"


def _is_whole(mutants: Sequence[Mutant], outcomes: Sequence[Outcome], rounds: int) -> bool:
    """Return whether each mutant has an outcome in each round; those of ladders need not be run."""
    known = {(outcome.mutant, outcome.round) for outcome in outcomes}
    alone = (mutant.id for mutant in mutants if not mutant.has_sizes)
    return all((name, round) in known for name in alone for round in range(rounds))


def _state(journal: JournalReader, shard: records.ShardOf | None, *, is_whole: bool) -> str:
    state = journal.finished or _unfinished(journal)
    if state == "complete" and not is_whole and (shard is None or shard.of == 1):
        return records.INCOMPLETE
    if shard is None or shard.of == 1:
        return state
    # a part of a campaign is never complete, whatever has become of it
    return shard.text if state == "complete" else f"{shard.text}, {state}"


def unlooked(results: Iterable[MutantResult]) -> list[str]:
    """Describe readings of the oracle of which no mutant was noticed.

    Of a reading with a mutant that is still to be run, as in another shard, nothing is said.
    """
    groups: dict[tuple[str, str], list[MutantResult]] = {}
    open_ones: set[tuple[str, str]] = set()
    for result in results:
        mutant = result.mutant
        is_reading = mutant.site.role is Role.ORACLE and mutant.operation and mutant.quantity
        key = (mutant.operation, mutant.quantity or "")
        if result.is_accepted:
            continue
        if is_reading and not result.outdated and result.kill_rate.valid:
            groups.setdefault(key, []).append(result)
        elif is_reading and not result.outcomes and not mutant.ladder:  # of a ladder, a search runs some
            open_ones.add(key)
    return [
        _unlooked_text(*key, found)
        for key, found in groups.items()
        if key not in open_ones and not any(result.kill_rate.killed for result in found)
    ]


def _unlooked_text(operation: str, quantity: str, found: Sequence[MutantResult]) -> str:
    """Describe an unnoticed reading: ``tests/sensors.py:12:5 tracker:position .y: none of its 3 mutants``."""
    places = in_short(list(dict.fromkeys(result.mutant.site.place for result in found)), 1)
    which = "its only mutant was not" if len(found) == 1 else f"none of its {len(found)} mutants was"
    return f"{places} {operation} {quantity}: {which} noticed"
