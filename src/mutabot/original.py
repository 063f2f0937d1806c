"""Facts about the original, the unmutated program, that are known when mutants are planned."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from mutabot.errors import MutabotError
from mutabot.frozen import frozen
from mutabot.model import Operation, Pattern, ProgramText, Sighting
from mutabot.model.codec import is_plain
from mutabot.model.events import TestEnd
from mutabot.model.job import Idle
from mutabot.model.mutant import Place
from mutabot.model.path import PathSteps
from mutabot.model.source_units import ExecutedByTests


@frozen
class TextSeen:
    """What the baseline observed in instrumented program text in a round.

    Attributes:
        imported: the files that were imported.
        sightings: what was seen at places.
        reached: numbers of the places that each test reached; the test ``""`` stands for before any test.
        below: the same in processes below the tests, by the origin of these.
        refused: files that could not be instrumented, with the reason.
    """

    imported: frozenset[str] = frozenset()
    sightings: tuple[Sighting, ...] = ()
    reached: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    below: Mapping[str, Mapping[str, tuple[int, ...]]] = field(default_factory=dict)
    refused: Mapping[str, str] = field(default_factory=dict)


@frozen
class Hit:
    """One recorded call: the values it wrote and read, and the round and test in which it was made."""

    written: Mapping[str, Any]
    read: Mapping[str, Any]
    where: tuple[int, str] = (0, "")


#: characters that all answers of one mutant may take; they go to every process that runs it
LIMIT = 1_000_000


class NoAnswerError(MutabotError):
    """It is unknown what the program would get if the robot did nothing; the text says why."""


@dataclass(slots=True)
class RecordedAnswers:
    """The recorded answers of one place, as ``runtime.interception.adapter`` writes them.

    Attributes:
        first: note of the first call that returned, by test (``Idle.key``).
        varying: the tests in which later calls returned something else.
        has_raised: whether any call raised.
    """

    first: dict[str, Any] = field(default_factory=dict)
    varying: dict[str, None] = field(default_factory=dict)
    has_raised: bool = False

    @property
    def is_nothing(self) -> bool:
        """Whether all calls that returned, returned None."""
        return not self.varying and all(note is None for note in self.first.values())

    def add(self, round: int, test: str, note: Any) -> None:
        """Add the answer of the place's next call in this test, or that it raised."""
        if isinstance(note, dict) and "raised" in note:
            self.has_raised = True
            return
        key = Idle.key(round, test)
        first = self.first.setdefault(key, note)
        if first is note or note == {"same": True}:
            return
        if type(first) is not type(note) or first != note:
            self.varying[key] = None


def idle_of(operation: Operation, pattern: Pattern | None, answers: RecordedAnswers) -> Any:
    """Return what the program gets when the command is left out, as a mutant carries it.

    What the vocabulary says goes first. Raises NoAnswerError.
    """
    idle = pattern.idle if pattern is not None and pattern.idle is not None else operation.idle
    if idle is not None:
        return Idle((idle,)).data()
    if not answers.first:
        raise NoAnswerError(f"no recorded call returned, so its answer is not known; {_HINT}")
    texts = {key: json.dumps(_kept(note)) for key, note in answers.first.items()}
    numbers = {text: number for number, text in enumerate(dict.fromkeys(texts.values()))}
    if sum(map(len, numbers)) > LIMIT:
        raise NoAnswerError(f"what it answers in all tests is more than {LIMIT} characters; {_HINT}")
    is_single = len(numbers) == 1 and not answers.varying
    of_test = {} if is_single else {key: numbers[text] for key, text in texts.items()}
    return Idle(tuple(map(json.loads, numbers)), of_test, tuple(answers.varying)).data()


_HINT = "say in the vocabulary what it returns while the robot does nothing: idle = …"


def _kept(note: Any) -> Any:
    if is_plain(note):
        return note
    if "kept" not in note:
        raise NoAnswerError(f"it returns a {note['opaque']}, which cannot be stored; {_HINT}")
    return note["kept"]


@dataclass(slots=True)
class Original:
    """What the baseline knows of the original.

    Attributes:
        tests: per round, the tests that ended alike in all repetitions and let the suite pass, in its order.
            A test that was skipped or failed as expected belongs to them: a mutant can make it fail.
        ends: the report of each (round, test), from the first repetition.
        executed: what was executed in this, by round.
        texts: the program text that was looked at, by the names of the providers that asked for it.
        text: what was seen of this, by round.
        hits: recorded calls by place, in the order in which places were first reached.
        answers: what these calls returned.
        read_parts: the paths into the results of a place's calls that are read; None if unknown.
        stand_ins: places at which a mock or a fake of the project gets calls.
        written_through: places that return the robot's own memory, to which the program writes.
        unreached: places of calls that no test reaches, found by the names of operations: a mutant there is
            not covered.
    """

    tests: list[list[str]] = field(default_factory=list)
    ends: dict[tuple[int, str], TestEnd] = field(default_factory=dict)
    executed: dict[int, ExecutedByTests] = field(default_factory=dict)
    texts: dict[str, tuple[ProgramText, ...]] = field(default_factory=dict)
    text: dict[int, TextSeen] = field(default_factory=dict)
    hits: dict[Place, list[Hit]] = field(default_factory=dict)
    answers: dict[Place, RecordedAnswers] = field(default_factory=dict)
    read_parts: dict[Place, frozenset[PathSteps] | None] = field(default_factory=dict)
    stand_ins: set[Place] = field(default_factory=set)
    written_through: set[Place] = field(default_factory=set)
    unreached: tuple[Place, ...] = ()

    def sightings(self) -> dict[int, Sighting]:
        """Return the merged observations of all rounds, by the numbers of the places in the program text.

        All kinds of values, and the variables that each round saw.
        """
        merged: dict[int, Sighting] = {}
        for seen in (sighting for _, text in sorted(self.text.items()) for sighting in text.sightings):
            before = merged.get(seen.place)
            merged[seen.place] = seen if before is None else before.with_others(seen)
        return merged

    def reached_places(self) -> set[int]:
        """Return the numbers of the places of the program text that tests, or processes below them, reach."""
        found = (tests for text in self.text.values() for tests in (text.reached, *text.below.values()))
        return {number for tests in found for numbers in tests.values() for number in numbers}

    def refused_files(self) -> dict[str, str]:
        """Return the files of the program whose text could not be instrumented, with the reason."""
        return {file: why for _, text in sorted(self.text.items()) for file, why in text.refused.items()}

    def readers(self, round: int, file: str) -> list[str]:
        """Return the tests of a round that may use the text of a file otherwise than by importing it.

        All from the first on that reads it, itself or in a process below it, also tests that are set aside:
        what a mutant does to code that was compiled does not show there.
        """
        executed = self.executed.get(round)
        return executed.from_reader_of(file) if executed is not None else []

    def is_read(self, file: str) -> bool:
        """Return whether tests may use the text of a file otherwise than by importing it, see ``readers``."""
        return any(self.readers(round, file) for round in range(len(self.tests)))

    def simulated(self, round: int, test: str) -> float:
        """Return the simulated seconds of a test; 0 without a clock, or if the test let no time pass."""
        return self.ends[round, test].simulated or 0.0
