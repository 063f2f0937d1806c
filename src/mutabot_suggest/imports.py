"""Adds imports to a file, placed and ordered as isort and ruff would."""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable, Collection, Iterable, Sequence
from itertools import pairwise
from typing import Any

ImportNode = ast.Import | ast.ImportFrom
#: width of lines where a file has no longer ones
_WIDTH = 88
_FUTURE, _STANDARD, _OTHERS, _OWN = range(4)


def with_imports(text: str, lines: Iterable[str], own: Collection[str] = ()) -> str:
    """Return a file's text with further imports, each ``import module`` or ``from module import name``.

    ``own``: names of the project's own modules.
    """
    newline = "\r\n" if "\r\n" in text else "\n"
    for line in dict.fromkeys(lines):
        text = _with_import(text.replace("\r\n", "\n"), line, own).replace("\n", newline)
    return text


def _with_import(text: str, line: str, own: Collection[str]) -> str:
    wanted = ast.parse(line).body[0]
    assert isinstance(wanted, ImportNode)
    tree = ast.parse(text)
    there = [statement for statement in tree.body if isinstance(statement, ImportNode)]
    if any(_has(present, wanted) for present in there):
        return text
    lines = text.split("\n")
    if isinstance(wanted, ast.ImportFrom):
        for known_import in there:
            same = isinstance(known_import, ast.ImportFrom) and (known_import.module, known_import.level) == (
                wanted.module,
                0,
            )
            source = "\n".join(lines[known_import.lineno - 1 : known_import.end_lineno])
            if same and "#" not in source and ";" not in source and "*" not in source:
                assert isinstance(known_import, ast.ImportFrom)
                lines[known_import.lineno - 1 : known_import.end_lineno] = _extended(
                    known_import, wanted.names[0].name, lines
                )
                return "\n".join(lines)
    _insert(lines, tree, _leading(tree), wanted, line, own)
    return "\n".join(lines)


def _has(known_import: ImportNode, wanted: ImportNode) -> bool:
    return ast.unparse(known_import) == ast.unparse(wanted) or (
        isinstance(known_import, ast.ImportFrom)
        and isinstance(wanted, ast.ImportFrom)
        and (known_import.module, known_import.level) == (wanted.module, 0)
        and any((alias.name, alias.asname) == (wanted.names[0].name, None) for alias in known_import.names)
    )


def _extended(node: ast.ImportFrom, name: str, lines: Sequence[str]) -> list[str]:
    """Return the lines of an import with a name added."""
    texts = [ast.unparse(alias) for alias in node.names]
    for key in (_by_type, str.casefold, str):
        if _is_sorted([key(text) for text in texts]):
            texts = sorted([*texts, name], key=key)
            break
    else:
        texts.append(name)
    start = f"from {node.module} import"
    line = f"{start} {', '.join(texts)}"
    was_one = node.lineno == node.end_lineno
    if was_one and len(line) <= max(_WIDTH, *map(len, lines)):
        return [line]
    return [f"{start} (", *(f"    {text}," for text in texts), ")"]


def _by_type(name: str) -> tuple[int, str]:
    """Return a sort key: constants, classes, then others, as ``order-by-type`` of isort and ruff."""
    kind = 0 if len(name) > 1 and name.isupper() else 1 if name[:1].isupper() else 2
    return kind, name


def _is_sorted(keys: Sequence[Any]) -> bool:
    return all(first <= second for first, second in pairwise(keys))


def _leading(tree: ast.Module) -> list[ImportNode]:
    """Return the imports at the beginning of a file."""
    found: list[ImportNode] = []
    for node in tree.body:
        if isinstance(node, ImportNode):
            found.append(node)
        elif not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)) or found:
            break
    return found


def _insert(
    lines: list[str],
    tree: ast.Module,
    there: Sequence[ImportNode],
    wanted: ImportNode,
    line: str,
    own: Collection[str],
) -> None:
    """Insert a new import into the block of its kind, in order, or into a new block."""
    blocks = _blocks(there)
    kind = _kind(wanted, own)
    fitting = [block for block in blocks if any(_root(import_node) == _root(wanted) for import_node in block)]
    fitting = fitting or [
        block for block in blocks if any(_kind(import_node, own) == kind for import_node in block)
    ]
    if fitting:
        block = max(fitting, key=lambda candidate: sum(_kind(node, own) == kind for node in candidate))
        keys: tuple[Callable[[ImportNode], Any], ...] = (_import_first, _module)
        key = next((key for key in keys if _is_sorted([key(import_node) for import_node in block])), None)
        before = [import_node for import_node in block if key is None or key(import_node) <= key(wanted)]
        at = (before[-1].end_lineno or 0) if before else block[0].lineno - 1
        lines.insert(at, line)
        return
    before = [block[-1] for block in blocks if _kind(block[-1], own) < kind]
    if before:
        lines[(at := before[-1].end_lineno or 0) : at] = ["", line]
    elif there:
        lines[(at := there[0].lineno - 1) : at] = [line, ""]
    else:
        first = tree.body[0] if tree.body else None
        is_docstring = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant)
        at = (first.end_lineno or 0) if first is not None and is_docstring else 0
        lines[at:at] = ["", line] if is_docstring else [line, ""]


def _blocks(nodes: Sequence[ImportNode]) -> list[list[ImportNode]]:
    """Return the groups of imports without an empty line between them."""
    found: list[list[ImportNode]] = []
    for node in nodes:
        if found and node.lineno == (found[-1][-1].end_lineno or 0) + 1:
            found[-1].append(node)
        else:
            found.append([node])
    return found


def _module(node: ImportNode) -> str:
    if isinstance(node, ast.ImportFrom):
        return f"{'.' * node.level}{node.module or ''}".lower()
    return node.names[0].name.lower()


def _import_first(node: ImportNode) -> tuple[bool, str]:
    """Return a sort key: ``import a`` before ``from b import c``, isort's default."""
    return isinstance(node, ast.ImportFrom), _module(node)


def _root(node: ImportNode) -> str:
    return _module(node).partition(".")[0]


def _kind(node: ImportNode, own: Collection[str]) -> int:
    root = _root(node)
    if root == "__future__":
        return _FUTURE
    if root in sys.stdlib_module_names:
        return _STANDARD
    return _OWN if root in own or not root else _OTHERS
