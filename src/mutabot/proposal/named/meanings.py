"""What the parts of messages mean, by the types that hold them and their names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from mutabot.model.named import Form
from mutabot.proposal.guess import Guess

from .seen import Part, Use


@dataclass(frozen=True)
class Place:
    """Where parts pass.

    Attributes:
        form: what is done.
        words: the words of its name.
        is_written: whether the program sends them.
        frame: the frame that all messages speak of; empty if there are several or none.
    """

    form: Form
    words: tuple[str, ...]
    is_written: bool
    frame: str = ""

    @classmethod
    def of(cls, use: Use, parts: Sequence[Part], *, is_written: bool) -> Place:
        """The place of what passes in a use."""
        words = tuple(word.lower() for word in re.findall(r"[A-Za-z]+|\d+", use.name))
        return cls(use.form, words, is_written)

    def is_nothing(self, part: Part) -> bool:
        """Whether a part is not worth asking about."""
        return False


def meaning(part: Part, place: Place) -> dict[str, Guess]:
    """What a part means, by path; nothing if nothing tells."""
    return {}
