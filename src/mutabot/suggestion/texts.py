"""Changes of text files: what is put where, the texts that come of it, and the diff."""

from __future__ import annotations

import ast
import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Insertion:
    """Lines that are put into a file.

    Attributes:
        file: relative to the project.
        after: the 1-based line after which they come; 0 for the beginning.
        lines: without their ends.
    """

    file: str
    after: int
    lines: tuple[str, ...]


def changed_texts(root: Path, insertions: Iterable[Insertion]) -> dict[str, str]:
    """The new texts of the files that change, by file. Equal lines at one place are put there once."""
    by_file: dict[str, dict[Insertion, None]] = {}
    for one in insertions:
        by_file.setdefault(one.file, {})[one] = None
    return {file: _changed(read_text(root, file), list(found)) for file, found in by_file.items()}


def read_text(root: Path, file: str) -> str:
    """The text of a project's file, with its own ends of lines."""
    return (root / file).read_bytes().decode("utf-8")


def _changed(text: str, insertions: list[Insertion]) -> str:
    lines = text.splitlines(keepends=True)
    end = "\r\n" if lines and lines[0].endswith("\r\n") else "\n"
    if lines and not lines[-1].endswith("\n"):
        lines[-1] += end
    for after in sorted({one.after for one in insertions}, reverse=True):
        added = [line + end for one in insertions if one.after == after for line in one.lines]
        lines[after:after] = added
    return "".join(lines)


def diff_of(root: Path, texts: Mapping[str, str]) -> str:
    """One unified diff of all changed and new files, for ``git apply`` and ``patch -p1``."""
    parts: list[str] = []
    for file, text in sorted(texts.items()):
        is_new = not (root / file).exists()
        before = [] if is_new else read_text(root, file).splitlines(keepends=True)
        name = "/dev/null" if is_new else f"a/{file}"
        for line in difflib.unified_diff(before, text.splitlines(keepends=True), name, f"b/{file}"):
            parts.append(line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n")
    return "".join(parts)


@dataclass(frozen=True, slots=True)
class Name:
    """How something of a module is named in a file.

    Attributes:
        text: the name.
        needs: the import that the file lacks, or None.
    """

    text: str
    needs: str | None = None


def name_in(module: ast.Module, wanted: str, attribute: str, taken: Iterable[str] = ()) -> Name:
    """How a file can name ``attribute`` of the module ``wanted``; ``taken`` are names of other things."""
    bound: set[str] = set(taken)
    for node in module.body:
        if isinstance(node, ast.ImportFrom) and node.module == wanted and not node.level:
            for alias in node.names:
                if alias.name == attribute and (alias.asname or alias.name) not in bound:
                    return Name(alias.asname or alias.name)
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name == wanted and (alias.asname or alias.name.partition(".")[0]) not in bound:
                    return Name(f"{alias.asname or alias.name}.{attribute}")
    bound |= top_names(module)
    if attribute not in bound:
        return Name(attribute, f"from {wanted} import {attribute}")
    return Name(f"{wanted}.{attribute}", f"import {wanted}")


def top_names(module: ast.Module) -> set[str]:
    """The names that a file binds at its top level."""
    found: set[str] = set()
    for node in module.body:
        if isinstance(node, ast.Import | ast.ImportFrom):
            found |= {alias.asname or alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            found.add(node.name)
        else:
            found |= {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}
    return found


def imports_of(file: str, module: ast.Module, imports: Iterable[str]) -> list[Insertion]:
    """What puts imports into a file: each before the first of its own that sorts after it."""
    return [Insertion(file, _line_for(module, line), (line,)) for line in sorted(set(imports))]


def _line_for(module: ast.Module, line: str) -> int:
    own = [node for node in module.body if isinstance(node, ast.Import | ast.ImportFrom)]
    own = [node for node in own if getattr(node, "module", None) != "__future__"]
    if own:
        first = _run(own)
        before = [node for node in first if _rank(ast.unparse(node)) < _rank(line)]
        return (before[-1].end_lineno or 0) if before else first[0].lineno - 1
    head = [
        node
        for node in module.body[:2]
        if isinstance(node, ast.ImportFrom) or (isinstance(node, ast.Expr) and _is_text(node.value))
    ]
    return (head[-1].end_lineno or 0) if head else 0


def _run(nodes: list[ast.Import | ast.ImportFrom]) -> list[ast.Import | ast.ImportFrom]:
    """The last of the blocks of imports that no empty line divides."""
    found = [nodes[0]]
    for node in nodes[1:]:
        if node.lineno - (found[-1].end_lineno or 0) > 1:
            found = []
            found.append(node)
        else:
            found.append(node)
    return found


def _rank(line: str) -> tuple[bool, str]:
    return line.startswith("from"), line.split()[1]


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)
