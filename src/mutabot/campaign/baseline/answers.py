"""What calls of one place returned in the baseline, and what a mutant that leaves them out answers."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

from mutabot.border.job import Idle
from mutabot.errors import MutabotError
from mutabot.model import Operation, Pattern
from mutabot.model.values.answer import is_plain

#: characters that all answers of one mutant may take; they go to every process that runs it
LIMIT = 1_000_000
_MISSING = object()


class NoAnswerError(MutabotError):
    """Nobody knows what the program would get if the robot did nothing; the text says why."""


@dataclass(slots=True)
class RecordedAnswers:
    """The notes of what calls of one place returned, as ``inside.calls.answers`` writes them.

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
        """Whether all calls that returned, returned nothing (None)."""
        return not self.varying and all(note is None for note in self.first.values())

    def add(self, round: int, test: str, note: Any) -> None:
        """The next call of the place in this test has returned, or raised."""
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
    """What the program gets when the command is left out, as a mutant carries it.

    What the vocabulary says goes first. Raises NoAnswerError.
    """
    told = pattern.idle if pattern is not None and pattern.idle is not None else operation.idle
    if told is not None:
        return Idle((told,)).data()
    if not answers.first:
        raise NoAnswerError(f"no recorded call returned, so nobody knows what it answers; {_HINT}")
    numbers: dict[str, int] = {}
    of_test = {}
    kept: list[Any] = []
    for key, note in answers.first.items():
        data = _kept(note)
        number = numbers.setdefault(json.dumps(data), len(numbers))
        if number == len(kept):
            kept.append(data)
        of_test[key] = number
    if sum(map(len, numbers)) > LIMIT:
        raise NoAnswerError(f"what it answers in all tests is more than {LIMIT} characters; {_HINT}")
    is_single = len(kept) == 1 and not answers.varying
    return Idle(tuple(kept), {} if is_single else of_test, tuple(answers.varying)).data()


_HINT = "say in the vocabulary what to answer while the robot does nothing: idle = …"


def _kept(note: Any) -> Any:
    if is_plain(note):
        return note
    data = note.get("kept", _MISSING)
    if data is _MISSING:
        raise NoAnswerError(f"what it answers cannot be kept ({note['opaque']}); {_HINT}")
    return data
