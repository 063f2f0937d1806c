"""Messages that the page on troubleshooting explains are messages that mutabot has."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "troubleshooting.md"
SOURCES = ROOT / "src"
#: stands on the page and in templates for what differs from project to project
_ANYTHING = "…"


def quoted() -> list[str]:
    """The messages in headings and in the table of reasons."""
    return re.findall(r"^(?:### |\| )`([^`]+)`", PAGE.read_text(encoding="utf-8"), re.MULTILINE)


def fragments(message: str) -> list[str]:
    """What of a message is the same in every project."""
    parts = (part.strip(" :;,()\n") for part in re.split(rf"{_ANYTHING}|: |\n|  +", message))
    return [part for part in parts if part]


@cache
def messages() -> dict[str, str]:
    """Per module all texts but docstrings, one a line, with ``…`` for what is filled in."""
    found = {}
    for path in sorted(SOURCES.rglob("*.py")):
        texts = _texts(ast.parse(path.read_text(encoding="utf-8")))
        found[str(path)] = "\n".join(text.replace("`", "") for text in texts)
    return found


def _texts(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return  # a docstring
    if isinstance(node, ast.JoinedStr):
        yield "".join(
            str(part.value) if isinstance(part, ast.Constant) else _ANYTHING for part in node.values
        )
    elif isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    for child in ast.iter_child_nodes(node):
        yield from _texts(child)


def test_a_message_on_the_page_is_one_of_ours() -> None:
    assert [fault for message in quoted() if (fault := foreign(message))] == []


def foreign(message: str) -> str:
    """What is wrong with a message on the page, or nothing."""
    wanted = fragments(message)
    if max(map(len, wanted)) < 8:
        return f"{message!r}: too little of it to be found by"
    missing = [[text for text in wanted if text not in texts] for texts in messages().values()]
    return (
        "" if [] in missing else f"no module has all of {wanted}; the nearest lacks {min(missing, key=len)}"
    )


def test_the_page_explains_each_message_once() -> None:
    found = quoted()
    assert len(found) == len(set(found)) > 40
