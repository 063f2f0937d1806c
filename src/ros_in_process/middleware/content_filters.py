"""Content filters of subscriptions, in DDS's subset of SQL, such as `data > %0`."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable
from fnmatch import fnmatchcase
from typing import Any

from ros_in_process.middleware.records import RCLError

RowTest = Callable[[Any], bool]
RowValue = Callable[[Any], Any]

_TOKEN = re.compile(
    r"\s*(%\d+|'[^']*'|[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?|<>|!=|<=|>=|[=<>()]|[A-Za-z_][\w.]*(?:\[\d+\])?)"
)
_COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "=": operator.eq, "<>": operator.ne, "!=": operator.ne,
    "<": operator.lt, ">": operator.gt, "<=": operator.le, ">=": operator.ge,
    "LIKE": lambda value, pattern: fnmatchcase(str(value), str(pattern).replace("%", "*").replace("_", "?")),
    "MATCH": lambda value, pattern: re.fullmatch(str(pattern), str(value)) is not None,
}  # fmt: skip


class ContentFilter:
    """Decides whether a subscription receives a message."""

    def __init__(self, expression: str, parameters: list[str]) -> None:
        self.expression, self.parameters = expression, list(parameters)
        self._words = _words(expression)
        self._test = self._either()
        if self._words:
            raise RCLError(f"failed to set content filter: unexpected {self._words[0]!r} in {expression!r}")

    def accepts(self, message: Any) -> bool:
        return self._test(message)

    def _next_is(self, word: str) -> bool:
        if self._words and self._words[0].upper() == word:
            self._words.pop(0)
            return True
        return False

    def _word(self) -> str:
        if not self._words:
            raise RCLError(f"failed to set content filter: {self.expression!r} ends too early")
        return self._words.pop(0)

    def _either(self) -> RowTest:
        tests = [self._both()]
        while self._next_is("OR"):
            tests.append(self._both())
        return lambda message: any(test(message) for test in tests)

    def _both(self) -> RowTest:
        tests = [self._one()]
        while self._next_is("AND"):
            tests.append(self._one())
        return lambda message: all(test(message) for test in tests)

    def _one(self) -> RowTest:
        if self._next_is("NOT"):
            inner = self._one()
            return lambda message: not inner(message)
        if self._next_is("("):
            inner = self._either()
            if not self._next_is(")"):
                raise RCLError(f"failed to set content filter: a bracket is open in {self.expression!r}")
            return inner
        return self._comparison()

    def _comparison(self) -> RowTest:
        left = self._value()
        is_negated = self._next_is("NOT")
        if self._next_is("BETWEEN"):
            low = self._value()
            if not self._next_is("AND"):
                raise RCLError(f"failed to set content filter: BETWEEN has no AND in {self.expression!r}")
            high = self._value()
            return lambda message: (low(message) <= left(message) <= high(message)) is not is_negated
        compare = _COMPARISONS.get(self._word().upper())
        if compare is None:
            raise RCLError(f"failed to set content filter: no comparison in {self.expression!r}")
        right = self._value()
        return lambda message: compare(left(message), right(message)) is not is_negated

    def _value(self) -> RowValue:
        word = self._word()
        if word.startswith("%"):
            word = self.parameters[int(word[1:])]
        if word.startswith("'"):
            return lambda message: word[1:-1]
        if re.fullmatch(r"[-+\d.eE]+", word):
            number = float(word)
            return lambda message: number
        if word.upper() in {"TRUE", "FALSE"}:
            return lambda message: word.upper() == "TRUE"
        return lambda message: _field(message, word)


def _words(expression: str) -> list[str]:
    found, at = [], 0
    while expression[at:].strip():
        match = _TOKEN.match(expression, at)
        if match is None:
            raise RCLError(f"failed to set content filter: {expression[at:]!r} is not understood")
        found.append(match[1])
        at = match.end()
    return found


def _field(message: Any, path: str) -> Any:
    for part in path.split("."):
        name, _, index = part.partition("[")
        message = getattr(message, name)
        if index:
            message = message[int(index.rstrip("]"))]
    return message
