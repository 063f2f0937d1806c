"""Moments: at which of the calls of its site a mutant acts.

Without a moment it acts at each of them. In a control loop that is no fault any robot has: a policy that is
wrong at 300 of 300 steps is noticed by every test.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import field, replace
from enum import StrEnum
from random import Random

from mutabot.frozen import frozen
from mutabot.limits import shortened


class When(StrEnum):
    """The kinds of moments, by the words that select them."""

    #: at the n-th call of a test alone
    NTH = "nth"
    #: at the n-th call of a test and all after it
    FROM = "from"
    #: at one call of a test, drawn anew for each round
    ONCE = "once"
    #: at the calls that begin in a window of the test's simulated time
    BETWEEN = "between"


#: the word for no moment
EVERY = "every"
_NUMBER = r"\d{1,9}(?:\.\d{0,9})?"
_FORMS: Mapping[When, re.Pattern[str]] = {
    When.NTH: re.compile(r"(?P<first>[1-9]\d{0,8})"),
    When.FROM: re.compile(r"from (?P<first>[1-9]\d{0,8})"),
    When.ONCE: re.compile(r"once"),
    When.BETWEEN: re.compile(rf"(?P<first>{_NUMBER}) ?s? ?(?:-|–|to) ?(?P<last>{_NUMBER}) ?s"),
}


@frozen
class Moment:
    """At which calls a mutant acts.

    Attributes:
        when: the kind of moment.
        first: the number of the call, from 1; or where the window begins, s after the test's first tick.
        last: where the window ends, s, that moment excluded; 0 for other kinds.
        calls: for a drawn call, how many calls the site has in the baseline, by round and test
            (``"0 tests/test_a.py::test"``).
    """

    when: When
    first: float = 0.0
    last: float = 0.0
    calls: Mapping[str, int] = field(default_factory=dict)

    @classmethod
    def parse(cls, text: str) -> Moment:
        """A moment as configuration and command line write it: ``3``, ``from 10``, ``once``, ``2-2.5 s``.

        Raises ValueError, which says what would be right.
        """
        for when, form in _FORMS.items():
            found = form.fullmatch(text.strip())
            if found is None:
                continue
            numbers = found.groupdict()
            moment = cls(when, float(numbers.get("first") or 0), float(numbers.get("last") or 0))
            if when is When.BETWEEN and not moment.first < moment.last:
                raise ValueError(f"{text!r} ends before it begins")
            return moment
        raise ValueError(
            f'{shortened(text)!r} is no moment; write "every", the number of a call ("3"), "from 3", "once", '
            'or a window of simulated time ("2-2.5 s")'
        )

    @classmethod
    def parse_any(cls, text: str) -> Moment | None:
        """The same, with None for every call."""
        return None if text.strip() == EVERY else cls.parse(text)

    @property
    def text(self) -> str:
        """The moment as it is written."""
        if self.when is When.NTH:
            return f"{self.first:g}"
        if self.when is When.FROM:
            return f"from {self.first:g}"
        if self.when is When.ONCE:
            return "once"
        return f"{self.first:g}-{self.last:g} s"

    @property
    def words(self) -> str:
        """The moment in a sentence about what the mutant does."""
        if self.when is When.NTH:
            return f"at call {self.first:g} only"
        if self.when is When.FROM:
            return f"from call {self.first:g} on"
        if self.when is When.ONCE:
            return "at one call, drawn for each round"
        return f"from {self.first:g} to {self.last:g} s of simulated time"

    @property
    def asks_time(self) -> bool:
        """Whether it needs a clock."""
        return self.when is When.BETWEEN

    def drawn(self, round: int, test: str, seed: int) -> Moment:
        """The same moment in a test: a call that is to be drawn is drawn, from ``seed`` alone.

        A test in which the baseline made no such call has none.
        """
        if self.when is not When.ONCE:
            return self
        calls = self.calls.get(f"{round} {test}", 0)
        return replace(self, first=float(Random(seed).randint(1, calls)) if calls else 0.0)

    def holds(self, call: int, time: float | None) -> bool:
        """Whether a call is meant: the ``call``-th of its site in the test, at ``time`` (s, if known)."""
        if self.when is When.BETWEEN:
            return time is not None and self.first <= time < self.last
        return call >= self.first if self.when is When.FROM else call == self.first
