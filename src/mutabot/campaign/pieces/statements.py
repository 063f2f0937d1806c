"""Statements: which of a function's statements stand in another version of it, and where."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher

from .piece import Piece, said

_BODIES = ("body", "orelse", "finalbody", "handlers", "cases")


@dataclass(frozen=True, slots=True)
class Statement:
    """One statement; of one with statements in it, its head.

    Attributes:
        said: what it says.
        nodes: its nodes, those of statements in it left out.
        lines: first and last line.
    """

    said: str
    nodes: tuple[ast.AST, ...]
    lines: tuple[int, int]

    def counts(self, text: str, *, calls: bool) -> int:
        """How often it holds an expression with this text, or a call of what has it."""
        found = (one for node in self.nodes for one in ast.walk(node))
        if calls:
            return sum(isinstance(one, ast.Call) and ast.unparse(one.func) == text for one in found)
        return sum(isinstance(one, ast.expr | ast.stmt) and ast.unparse(one) == text for one in found)


def statements(piece: Piece) -> list[Statement]:
    """Those of a piece, in the order of the text."""
    return [one for node in piece.nodes for one in _of(node)]


def matched(old: Sequence[Statement], new: Sequence[Statement]) -> dict[int, int]:
    """Which of the new statements stand in the old version: from the new position to the old one."""
    matcher = SequenceMatcher(None, [one.said for one in old], [one.said for one in new], autojunk=False)
    return {
        block.b + step: block.a + step
        for block in matcher.get_matching_blocks()
        for step in range(block.size)
    }


def _of(node: ast.AST) -> Iterator[Statement]:
    if not isinstance(node, ast.stmt | ast.ExceptHandler | ast.match_case):
        return
    inner = [one for name in _BODIES for one in getattr(node, name, ()) or () if isinstance(one, ast.AST)]
    own = (
        tuple(one for name, value in ast.iter_fields(node) if name not in _BODIES for one in _nodes(value))
        if inner
        else (node,)
    )
    lines = [getattr(one, "lineno", 0) for one in own] + [getattr(node, "lineno", 0)]
    ends = [getattr(one, "end_lineno", 0) or 0 for one in own] or lines
    first = min((line for line in lines if line), default=0)
    heading = type(node).__name__ if inner else ""
    yield Statement(heading + "; ".join(said(one, {}) for one in own), own, (first, max([*ends, first])))
    for one in inner:
        yield from _of(one)


def _nodes(value: object) -> list[ast.AST]:
    if isinstance(value, ast.AST):
        return [value]
    return [one for one in value if isinstance(one, ast.AST)] if isinstance(value, list) else []
