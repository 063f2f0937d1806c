"""The tree of a program, the same for all languages: nodes that know which part of the text they are.

Expressions have the kinds ``number``, ``text``, ``constant``, ``name``, ``call``, ``method``, ``index``,
``field``, ``unary``, ``binary``, ``group``, ``list``, ``pose``, ``aggregate`` (of ``pair``), ``enum``,
``option`` (of a call) and ``omitted``. Statements are ``assign``, ``if``, ``while``, ``for``, ``repeat``,
``loop``, ``switch``, ``return``, ``break``, ``continue``, ``goto``, ``label``, ``declare``, ``routine``,
``exit``, ``empty``, ``opaque`` (what could not be read) and calls.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

STATEMENTS = frozenset(
    {
        "assign", "if", "while", "for", "repeat", "loop", "switch", "return", "break", "continue", "goto",
        "declare", "exit", "opaque", "raise", "retry", "interrupt",
    }
)  # fmt: skip

_LONGEST = 60


class ProgramNode:
    """A part of a program.

    Attributes:
        kind: what it is.
        name: what is called, the operator, or the name; as the language compares names.
        start, end: offsets in the text.
        parts: expressions below it.
        bodies: statements below it: of each branch.
        value: of a literal; else what the language adds, such as the type of a declaration.
    """

    __slots__ = ("bodies", "end", "kind", "name", "parts", "start", "value")

    def __init__(
        self,
        kind: str,
        name: str,
        start: int,
        end: int,
        parts: list[ProgramNode] | None = None,
        bodies: list[list[ProgramNode]] | None = None,
        value: Any = None,
    ) -> None:
        self.kind, self.name, self.start, self.end = kind, name, start, end
        self.parts: Sequence[ProgramNode] = parts if parts is not None else ()
        self.bodies: Sequence[list[ProgramNode]] = bodies if bodies is not None else ()
        self.value = value

    @property
    def plain(self) -> list[ProgramNode]:
        """The parts that are no options, in their order."""
        return [part for part in self.parts if part.kind != "option"]

    @property
    def options(self) -> dict[str, ProgramNode]:
        """The options among the parts, by their names."""
        return {part.name: part for part in self.parts if part.kind == "option"}

    def walk(self) -> Iterator[ProgramNode]:
        """Yield this node and all below it, in the order of the text as far as it is one."""
        waiting = [self]
        while waiting:
            node = waiting.pop()
            yield node
            for body in reversed(node.bodies):
                waiting.extend(reversed(body))
            waiting.extend(reversed(node.parts))


def in_short(node: ProgramNode, text: str) -> str:
    """Return how a node of a text begins, on one line."""
    shown = " ".join(text[node.start : node.end].split("\n", maxsplit=1)[0].split())
    return shown if len(shown) <= _LONGEST else f"{shown[: _LONGEST - 1]}…"


def routines(tree: ProgramNode) -> Iterator[ProgramNode]:
    """Return the routines of a file, also those inside others."""
    return (node for node in tree.walk() if node.kind == "routine")
