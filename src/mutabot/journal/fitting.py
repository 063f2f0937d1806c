"""What rows of a journal may hold: whoever reads one checks it, since a file may come from anybody."""

from __future__ import annotations

import json
import math
import zlib
from typing import Any, TypeVar

from mutabot.model import By, LeftOut, Mutant, Outcome, Verdict
from mutabot.model.codec import from_data
from mutabot.model.events import TestEnd

from .records import FACTS, BaselineTest, Budgeted, ControlEnd, Reaching, ShardOf

T = TypeVar("T")
#: what reading a row raises that does not hold what it should
UNFIT = (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError, zlib.error)
#: rounds of a campaign, characters of a row, bytes of a file's text, and levels of nesting, at most
MOST_ROUNDS, _LONGEST, _LARGEST, _DEEPEST = 100_000, 1 << 28, 1 << 28, 100
MOST_SHARDS = 1_000_000
#: seconds since 1970 that a date can be made of, about the year 5000
_LATEST = 1e11


def load(text: Any) -> Any:
    """What a text says as JSON, if it says what our own JSON can."""
    if not isinstance(text, str) or len(text) > _LONGEST:
        raise TypeError
    value = json.loads(text)
    _refuse_excess(value, _DEEPEST)
    if "\\ud" in text.lower():  # half a character cannot be printed
        value = json.loads(json.dumps(value, ensure_ascii=False).encode("utf-8", "replace"))
    elif not text.isascii():
        text.encode()
    return value


def _refuse_excess(value: Any, depth: int) -> None:
    """Refuse what is nested too deeply, and numbers that nothing can be computed with."""
    kind = type(value)
    if kind is int:
        float(value)
    elif kind is list or kind is dict:
        if not depth:
            raise RecursionError
        for item in value.values() if kind is dict else value:
            if type(item) is not str:
                _refuse_excess(item, depth - 1)


def fact(key: str, value: Any) -> Any:
    """A fact of a campaign, if it can be one."""
    if value is None or key not in FACTS:
        return value
    found = from_data(FACTS[key], value)
    if key == "rounds" and not 0 < value <= MOST_ROUNDS:
        raise ValueError
    if isinstance(found, ShardOf) and not 1 <= found.number <= found.of <= MOST_SHARDS:
        raise ValueError
    if isinstance(found, Reaching) and not all(
        0 <= index < len(found.tests) for indexes in found.sites.values() for index in indexes
    ):
        raise ValueError
    if isinstance(found, Budgeted) and not (
        min(found.run, found.cut_off) >= 0 and found.run + found.cut_off <= found.planned
    ):
        raise ValueError
    if key in ("started", "seconds") and not 0 <= value <= _LATEST:
        raise ValueError
    return value


def is_round(value: Any) -> bool:
    """Whether this can be the number of a round."""
    return isinstance(value, int) and 0 <= value < MOST_ROUNDS


def round_in(value: Any) -> int:
    """The number of a round, or of a repetition."""
    if not is_round(value):
        raise ValueError
    return int(value)


def text_in(value: Any) -> str:
    """A text of a column."""
    if not isinstance(value, str):
        raise TypeError
    value.encode()  # there are no halves of characters in it
    return value


def agreed(value: T, *pairs: tuple[Any, Any]) -> T:
    """The value, if what it says of itself is what the columns beside it say."""
    if any(one != other for one, other in pairs):
        raise ValueError
    return value


def mutant_in(text: Any) -> Mutant:
    """A mutant."""
    found = from_data(Mutant, load(text))
    span = found.site.span
    for number in (found.number, span.line, span.end_line, span.column, span.end_column):
        _check_number(number)
    _check_number(found.magnitude, least=-math.inf)
    return found


def planned_in(number: Any, name: Any, text: Any) -> Mutant:
    """A mutant of the plan, if it is that of the columns beside it."""
    found = mutant_in(text)
    return agreed(found, (found.number, number), (found.id, name))


def known_in(name: Any, text: Any, outdated: Any) -> tuple[Mutant, bool]:
    """A mutant of an earlier campaign, and whether something has changed that it depends on."""
    found = mutant_in(text)
    return agreed(found, (found.id, name)), outdated != 0


def left_out_in(name: Any, reason: Any, text: Any) -> LeftOut:
    """What the plan leaves out."""
    found = from_data(LeftOut, load(text))
    return agreed(found, (found.id, name))


def baseline_test_in(round: Any, repetition: Any, name: Any, outcome: Any, text: Any) -> BaselineTest:
    """A test of the baseline."""
    found = BaselineTest(round_in(round), round_in(repetition), from_data(TestEnd, load(text)))
    return agreed(found, (found.test.test, name))


def control_in(file: Any, control: Any, ok: Any, detail: Any) -> ControlEnd:
    """A control."""
    return ControlEnd(text_in(file), text_in(control), ok == 1, text_in(detail))


def outcome_in(mutant: Any, round: Any, verdict: Any, by: Any, text: Any, *_: Any) -> Outcome:
    """An outcome, if it is that of the columns beside it."""
    found = from_data(Outcome, load(text))
    agreed(found, (found.mutant, text_in(mutant)), (found.round, round_in(round)))
    agreed(found, (found.verdict, Verdict(verdict)), (found.by, By(by) if by is not None else None))
    counts = (found.hits, found.acted, found.tests, found.repeats, found.commands, *found.away.values())
    for number in (*counts, found.wall, found.cpu):
        _check_number(number)
    return found


def _check_number(value: float | None, least: float = 0) -> None:
    if value is not None and not least <= value < math.inf:
        raise ValueError


def inflated(data: Any) -> bytes:
    """What was compressed."""
    if not isinstance(data, bytes):
        raise TypeError
    inflater = zlib.decompressobj()
    text = inflater.decompress(data, _LARGEST)
    if not inflater.eof:
        raise ValueError(f"more than {_LARGEST} bytes, or cut off")
    return text
