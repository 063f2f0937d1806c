"""Check what rows of a journal hold whenever they are read, since the file may come from a stranger."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any, TypeVar

from mutabot.journal.records import (
    FACTS,
    BaselineTest,
    Budgeted,
    KeptBaseline,
    OriginalRun,
    Reaching,
    ShardOf,
)
from mutabot.model import Mutant, Outcome
from mutabot.model.codec import from_data

T = TypeVar("T")
#: what reading a row raises that does not hold what it should
UNFIT = (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError)
#: rounds of a campaign, characters of a row, and levels of nesting, at most
MOST_ROUNDS, _LONGEST, _DEEPEST = 100_000, 1 << 28, 100
MOST_SHARDS = 1_000_000
#: seconds since 1970 that a date can be made of, about the year 5000
_LATEST = 1e11


def load(text: Any) -> Any:
    """Return the value of a JSON text, if mutabot's own JSON can have it."""
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
    """Raise ValueError for data nested too deeply, and for numbers that cannot be computed with."""
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
    """Return a fact of a campaign, checked for its type."""
    if value is None or key not in FACTS:
        return value
    found = from_data(FACTS[key], value)
    match found:
        case int() if key == "rounds":
            is_fine = 0 < found <= MOST_ROUNDS
        case int() | float() if key in ("started", "seconds"):
            is_fine = 0 <= found <= _LATEST
        case ShardOf():
            is_fine = 1 <= found.number <= found.of <= MOST_SHARDS
        case Reaching():
            indexes = {index for some in found.sites.values() for index in some}
            is_fine = indexes.issubset(range(len(found.tests)))
        case Budgeted():
            is_fine = min(found.run, found.cut_off) >= 0 and found.run + found.cut_off <= found.planned
        case _:
            is_fine = True
    if not is_fine:
        raise ValueError
    return found


def round_in(value: Any) -> int:
    """Return the number of a round or repetition, checked."""
    if not isinstance(value, int) or not 0 <= value < MOST_ROUNDS:
        raise ValueError
    return value


def text_in(value: Any) -> str:
    """Return a text of a column, checked."""
    if not isinstance(value, str):
        raise TypeError
    value.encode()  # there are no halves of characters in it
    return value


#: attributes that are repeated in columns of their own
_REPEATED = ("id", "mutant", "round", "verdict", "task")


def held(kind: type[T], row: Mapping[str, Any]) -> T:
    """Return the object whose JSON a row holds, if the row's other columns agree with it."""
    found = from_data(kind, load(row["data"]))
    if any(getattr(found, name) != row[name] for name in _REPEATED if name in row):
        raise ValueError
    match found:
        case Mutant(site=site):
            for span in site.spans:
                _check_numbers(found.number, span.line, span.end_line, span.column, span.end_column)
            _check_numbers(found.magnitude, least=-math.inf)
        case KeptBaseline():
            _check_numbers(found.taken, _LATEST - found.taken)
        case OriginalRun():
            _check_numbers(found.wall)
        case BaselineTest():
            round_in(found.round), round_in(found.repetition)
        case Outcome():
            round_in(found.round)
            counts = (found.hits, found.acted, found.tests, found.repeats, found.commands)
            _check_numbers(*counts, found.wall, found.cpu, *found.away.values())
    return found


def _check_numbers(*values: float | None, least: float = 0) -> None:
    if any(value is not None and not least <= value < math.inf for value in values):
        raise ValueError
