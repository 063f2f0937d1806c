"""What docstrings list exists, and the first line of a function's says what it does."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TypeAlias, TypeGuard

import pytest

_Function: TypeAlias = ast.FunctionDef | ast.AsyncFunctionDef

SOURCE = Path(__file__).parents[1] / "src"
#: a section, and each name in it: what stands four columns in, before a colon
_SECTION = re.compile(r"^(?:Args|Attributes):\n((?:    .*\n?|\n)+)", re.MULTILINE)
_NAMES = re.compile(r"^    (\*{0,2}\w+(?:, \*{0,2}\w+)*):", re.MULTILINE)

#: words with which a noun phrase or a clause begins
_NO_VERBS = {
    "A", "All", "An", "Each", "How", "Its", "The", "These", "Those", "What", "When", "Where", "Whether",
    "Which", "Who", "Why",
}  # fmt: skip


def test_the_first_line_of_a_function_says_what_it_does() -> None:
    """Properties are values, so theirs say what they are."""
    found = [
        f"{file.relative_to(SOURCE)}:{node.lineno} {node.name}: {first}"
        for file in sorted(SOURCE.rglob("*.py"))
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, _Function) and not _is_value(node)
        for first in (ast.get_docstring(node) or "").splitlines()[:1]
        if first.partition(" ")[0] in _NO_VERBS
    ]
    assert found == []


def _is_value(function: _Function) -> bool:
    """Return whether a function is a property or sets one."""
    names = [ast.unparse(decorator) for decorator in function.decorator_list]
    return any("property" in name or name.endswith(".setter") for name in names)


def test_docstrings_list_arguments_and_attributes_that_exist() -> None:
    files = sorted(SOURCE.rglob("*.py"))
    assert files
    found = [
        f"{file.relative_to(SOURCE)}: {missing}"
        for file in files
        for missing in _missing(file.read_text(encoding="utf-8"))
    ]
    assert found == []


@pytest.mark.parametrize(
    ("body", "missing"),
    [
        ("    speed: float\n", []),
        ("    def __init__(self, speed): ...\n", []),
        ("    def __init__(self): self.speed = 1.0\n", []),
        ("    @property\n    def speed(self): ...\n", []),
        ("    velocity: float\n", ["Belt: speed"]),
    ],
)
def test_a_name_that_is_gone_is_found(body: str, missing: list[str]) -> None:
    text = f'class Belt:\n    """A belt.\n\n    Attributes:\n        speed: m/s.\n    """\n{body}'
    assert list(_missing(text)) == missing


def _missing(text: str) -> Iterator[str]:
    """Yield what docstrings list and what is described does not have."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ClassDef):
            existing = _members(node)
        elif isinstance(node, _Function):
            existing = _parameters(node)
        else:
            continue
        for section in _SECTION.findall(ast.get_docstring(node) or ""):
            for names in _NAMES.findall(section):
                for name in names.replace("*", "").split(", "):
                    if name not in existing:
                        yield f"{node.name}: {name}"


def _members(node: ast.ClassDef) -> set[str]:
    found = set[str]()
    for part in node.body:
        if isinstance(part, _Function):
            found |= {part.name, *(_parameters(part) if part.name in ("__init__", "__new__") else ())}
            found |= {inner.attr for inner in ast.walk(part) if _is_assigned(inner)}
        elif isinstance(part, ast.AnnAssign | ast.Assign):
            found |= {inner.id for inner in ast.walk(part) if isinstance(inner, ast.Name)}
    return found


def _is_assigned(node: ast.AST) -> TypeGuard[ast.Attribute]:
    return isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)


def _parameters(node: _Function) -> set[str]:
    return {argument.arg for argument in ast.walk(node.args) if isinstance(argument, ast.arg)}
