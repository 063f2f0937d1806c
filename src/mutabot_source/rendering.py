"""Alternatives as text: for the compiler with what is kept named, for people as it would read."""

from __future__ import annotations

import ast
from collections.abc import Callable

import libcst as cst

from mutabot.model.alternative import kept_name

#: longer texts are cut in ids and descriptions
TEXT_LIMIT = 60
Parts = tuple[str | cst.CSTNode, ...]


def template(parts: Parts, number_of: Callable[[cst.CSTNode], int]) -> str:
    """The parts with a name for each node that is kept."""
    return "".join(part if isinstance(part, str) else kept_name(number_of(part)) for part in parts)


def shown(parts: Parts, text_of: Callable[[cst.CSTNode], str]) -> str:
    """The parts as program text, with parentheses only where they are needed."""
    bare = _joined(parts, text_of)
    if len(parts) == 1:
        return bare
    wrapped = _joined(parts, lambda node: f"({text_of(node)})")
    return bare if same_program(bare, wrapped) else _joined(parts, lambda node: _wrapped(node, text_of))


def same_program(one: str, other: str) -> bool:
    """Whether two texts mean the same to the parser."""
    try:
        return ast.dump(ast.parse(one)) == ast.dump(ast.parse(other))
    except SyntaxError:
        return False


def shortened(text: str) -> str:
    """One line of limited length."""
    text = " ".join(text.split())
    return text if len(text) <= TEXT_LIMIT else text[: TEXT_LIMIT - 1] + "…"


def _joined(parts: Parts, text_of: Callable[[cst.CSTNode], str]) -> str:
    return "".join(part if isinstance(part, str) else text_of(part) for part in parts)


def _wrapped(node: cst.CSTNode, text_of: Callable[[cst.CSTNode], str]) -> str:
    atoms = cst.Name | cst.Attribute | cst.Subscript | cst.Call | cst.Integer | cst.Float | cst.SimpleString
    return text_of(node) if isinstance(node, atoms) else f"({text_of(node)})"
