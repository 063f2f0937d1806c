"""Builds calls with other arguments, as text and nodes of the original."""

from __future__ import annotations

import ast
from collections.abc import Iterable

from mutabot_source.operator import TextParts


def call(node: ast.Call, keywords: Iterable[ast.keyword], arguments: Iterable[ast.expr] = ()) -> TextParts:
    """Return a call with these keywords, and its own positional arguments or these."""
    given: list[TextParts] = [
        ("*", expression.value) if isinstance(expression, ast.Starred) else (expression,)
        for expression in arguments or node.args
    ]
    given += [(f"{keyword.arg}=" if keyword.arg is not None else "**", keyword.value) for keyword in keywords]
    parts: list[str | ast.expr] = [node.func, "("]
    for number, argument in enumerate(given):
        parts += [", "] if number else []
        parts += argument
    return (*parts, ")")


def last_name(node: ast.expr) -> str:
    """Return the last part of the called name; empty if it has none."""
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""
