"""Tokens that lose nothing: joined, with the trivia between them, they are the text."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

#: kinds that no grammar sees
TRIVIA = frozenset({"space", "comment"})


@dataclass(frozen=True, slots=True)
class Lexis:
    """What a language's tokens look like.

    Attributes:
        pattern: alternatives with a named group each; ``space`` and ``comment`` are trivia, ``newline`` ends
            a statement where the language says so, ``other`` takes any character that nothing else does.
        ignores_case: whether names that differ in capital letters are equal.
        marked: the patterns by their names.
    """

    pattern: re.Pattern[str]
    ignores_case: bool
    marked: Mapping[str, str]

    @classmethod
    def of(cls, groups: dict[str, str], *, ignores_case: bool) -> Lexis:
        """Return a lexis of these patterns, tried in their order."""
        alternatives = "|".join(f"(?P<{name}>{pattern})" for name, pattern in groups.items())
        return cls(re.compile(f"{alternatives}|(?P<other>.)", re.DOTALL | re.MULTILINE), ignores_case, groups)


@dataclass(slots=True)
class Tokens:
    """The tokens that a grammar sees, and one more at the end.

    Attributes:
        kinds, words, starts, ends: by token; words are in small letters where case does not matter.
    """

    kinds: list[str] = field(default_factory=list)
    words: list[str] = field(default_factory=list)
    starts: list[int] = field(default_factory=list)
    ends: list[int] = field(default_factory=list)


def scan(text: str, lexis: Lexis) -> Tokens:
    """Return the tokens of a text without trivia."""
    kinds, words, starts, ends = list[str](), list[str](), list[int](), list[int]()
    for found in lexis.pattern.finditer(text):
        kind = found.lastgroup or ""
        if kind in TRIVIA:
            continue
        kinds.append(kind)
        words.append(found.group())
        start, end = found.span()
        starts.append(start)
        ends.append(end)
    if lexis.ignores_case:
        words = [word.lower() for word in words]
    kinds.append("end")
    words.append("")
    starts.append(len(text))
    ends.append(len(text))
    return Tokens(kinds, words, starts, ends)
