"""Family ``text``: single characters of a text argument go wrong.

The naive operator: it knows nothing of the command that the text is. Made to be compared with.
"""

from __future__ import annotations

import ast
from abc import abstractmethod
from collections.abc import Iterable, Iterator
from hashlib import sha256
from itertools import pairwise
from random import Random
from typing import ClassVar

from mutabot_source.extension import TEXT
from mutabot_source.operator import ConventionalOperator, Draft, Surroundings, SyntaxNode, TextExample

#: alternatives per text and operator
LIMIT = 4
_LETTERS = "abcdefghijklmnopqrstuvwxyz"
_DIGITS = "0123456789"


class _Characters(ConventionalOperator):
    """Changes single characters of strings that are arguments of calls."""

    family = TEXT

    def drafts(self, node: SyntaxNode, around: Surroundings) -> Iterable[Draft]:
        if not isinstance(node, ast.Constant) or not around.is_argument:
            return
        text = node.value
        if not isinstance(text, str):
            return
        random = Random(int.from_bytes(sha256(f"{self.name}:{text}".encode()).digest()[:8]))
        made = list(self._changed(text, random))
        chosen = sorted(random.sample(range(len(made)), min(LIMIT, len(made))))
        taken = {text}
        for index in chosen:
            variant, changed = made[index]
            if changed not in taken:
                taken.add(changed)
                yield Draft(variant, (repr(changed),))

    @abstractmethod
    def _changed(self, text: str, random: Random) -> Iterator[tuple[str, str]]:
        """Yield variants, each with the changed text."""


class DropCharacter(_Characters):
    """A character of a text argument is left out."""

    name = "drop-character"
    rank = 120
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("send('up')\n", ("send('p')\n", "send('u')\n")),
        TextExample("send(up)\n", note="only texts that stand in the call"),
        TextExample("x = 'up'\n"),
    )

    def _changed(self, text: str, random: Random) -> Iterator[tuple[str, str]]:
        for index in range(len(text)):
            yield str(index + 1), text[:index] + text[index + 1 :]


class DoubleCharacter(_Characters):
    """A character of a text argument is there twice."""

    name = "double-character"
    rank = 130
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("send('up')\n", ("send('uup')\n", "send('upp')\n")),
        TextExample("send(f'up/{x}')\n", note="not in formatted texts"),
    )

    def _changed(self, text: str, random: Random) -> Iterator[tuple[str, str]]:
        for index in range(len(text)):
            yield str(index + 1), text[: index + 1] + text[index:]


class ReplaceCharacter(_Characters):
    """A character of a text argument is another one: a digit for a digit, a letter for a letter."""

    name = "replace-character"
    rank = 140
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("send('up5')\n", ("send('np5')\n", "send('ul5')\n", "send('up8')\n")),
        TextExample("send('')\n", note="an empty text has no characters"),
    )

    def _changed(self, text: str, random: Random) -> Iterator[tuple[str, str]]:
        for index, old in enumerate(text):
            letters = _LETTERS.upper() if old.isupper() else _LETTERS
            new = random.choice((_DIGITS if old.isdigit() else letters).replace(old, ""))
            yield str(index + 1), text[:index] + new + text[index + 1 :]


class SwapCharacters(_Characters):
    """Two neighbouring characters of a text argument change places."""

    name = "swap-characters"
    rank = 150
    examples: ClassVar[tuple[TextExample, ...]] = (
        TextExample("send('up')\n", ("send('pu')\n",)),
        TextExample("send('aa')\n", note="equal neighbours"),
    )

    def _changed(self, text: str, random: Random) -> Iterator[tuple[str, str]]:
        for index, (first, second) in enumerate(pairwise(text)):
            if first != second:
                yield str(index + 1), text[:index] + second + first + text[index + 2 :]
