"""The pieces of a Python file: each function, class and constant by itself, and the rest of the module.

What a piece says is its syntax tree, without positions, comments and layout, and what the names in it stand
for: two pieces that say the same do the same.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterable
from dataclasses import field
from enum import StrEnum

from mutabot.frozen import frozen

from .mentions import Mentions


class Kind(StrEnum):
    """What a piece is."""

    FUNCTION = "function"
    CLASS = "class"
    CONSTANT = "constant"
    #: what runs whenever the module is imported
    MODULE = "module"
    #: what stands under ``if __name__ == "__main__"``
    MAIN = "main"
    #: a name of another module that this one only passes on
    PASSED = "passed"
    #: a file that cannot be taken apart
    FILE = "file"


@frozen
class Piece:
    """One piece of a file.

    Attributes:
        file: its path relative to the project.
        name: its qualified name in the module; empty for the rest of the module.
        kind: what it is.
        nodes: the statements that it consists of.
        mentions: the names that it mentions.
        is_root: whether it is reached by whoever imports the module, mentioned or not.
        bases: of a class, the last names of its bases.
        methods: of a class, the names of its methods.
        text: of a file that cannot be taken apart, its digest.
    """

    file: str
    name: str
    kind: Kind
    nodes: tuple[ast.AST, ...] = field(default=(), compare=False, hash=False)
    mentions: Mentions = field(default_factory=Mentions, compare=False, hash=False)
    is_root: bool = False
    bases: tuple[str, ...] = ()
    methods: tuple[str, ...] = ()
    text: str = ""

    @property
    def last(self) -> str:
        """The last part of its name, by which others mention it."""
        return self.name.rpartition(".")[2]

    @property
    def shown(self) -> str:
        """In words: ``place() in sorting.py``."""
        match self.kind:
            case Kind.FUNCTION:
                return f"{self.name}() in {self.file}"
            case Kind.CLASS | Kind.CONSTANT | Kind.PASSED:
                return f"{self.name} in {self.file}"
            case Kind.MODULE:
                return f"module level of {self.file}"
            case Kind.MAIN:
                return f"the main block of {self.file}"
            case Kind.FILE:
                return self.file

    def digest(self, bound: Iterable[tuple[str, tuple[str, ...]]]) -> str:
        """What it says, as a digest.

        Args:
            bound: names in it that stand for something elsewhere, and for what.
        """
        if self.kind is Kind.FILE:
            return self.text
        whole = [ast.dump(node) for node in self.nodes]
        return hashlib.blake2b(repr((whole, sorted(bound))).encode(), digest_size=12).hexdigest()
