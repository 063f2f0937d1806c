"""Measure the code: lines without docstrings, comments and blank lines, modules, chains of imports.

    python tools/measure_code.py [FOLDER …]      every package in src if none is named

Prints a line for each top folder, and of each package: modules, lines of code, lines that import, the longest
chain of imports.
"""

from __future__ import annotations

import ast
import io
import sys
import tokenize
from collections import Counter
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
_NO_CODE = {
    tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENCODING,
    tokenize.ENDMARKER,
}  # fmt: skip


def lines_of_code(text: str) -> int:
    """Lines that hold a token of code; of docstrings none does."""
    told = {line for node in docstrings(ast.parse(text)) for line in range(node.lineno, _end(node) + 1)}
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    lines = {
        line
        for token in tokens
        if token.type not in _NO_CODE
        for line in range(token.start[0], token.end[0] + 1)
    }
    return len(lines - told)


def docstrings(tree: ast.Module) -> list[ast.Expr]:
    """Statements that are a text alone: docstrings, also those below a field."""
    return [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    ]


def import_lines(text: str) -> int:
    """Lines of statements that import."""
    nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import | ast.ImportFrom)]
    return sum(_end(node) - node.lineno + 1 for node in nodes)


def _end(node: ast.stmt) -> int:
    return node.end_lineno or node.lineno


def imported(folder: Path) -> dict[Path, set[Path]]:
    """Which modules of a package each of its modules imports when it is imported itself."""
    files = set(folder.rglob("*.py"))
    found: dict[Path, set[Path]] = {}
    for file in files:
        # the packages around a module are no links of a chain
        own = {file, *(parent / "__init__.py" for parent in file.parents)}
        found[file] = (_imports(file, folder) & files) - own
    return found


def _imports(file: Path, folder: Path) -> set[Path]:
    found: set[Path] = set()
    for node in _at_import(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names = [alias.name.split(".") for alias in node.names]
            places = [folder.parent.joinpath(*name) for name in names]
        else:
            base = file.parent if node.level else folder.parent
            for _ in range(node.level - 1):
                base = base.parent
            base = base.joinpath(*(node.module or "").split(".")) if node.module else base
            places = [base, *(base / alias.name for alias in node.names)]
        found |= {place.with_suffix(".py") for place in places} | {place / "__init__.py" for place in places}
    return found


def _at_import(tree: ast.Module) -> list[ast.Import | ast.ImportFrom]:
    return [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]


def longest_chain(graph: dict[Path, set[Path]]) -> int:
    """Files in the longest chain of imports."""

    @cache
    def below(file: Path) -> int:
        return 1 + max(map(below, graph[file]), default=0)

    sys.setrecursionlimit(10_000)
    return max(map(below, graph), default=0)


def main(folders: list[Path]) -> None:
    """Print the measures."""
    unknown = [str(folder) for folder in folders if not folder.is_dir()]
    if unknown:
        raise SystemExit(f"no such folder: {', '.join(unknown)}\n\n{__doc__}")
    total = 0
    for folder in folders:
        texts = {file: file.read_text(encoding="utf-8") for file in sorted(folder.rglob("*.py"))}
        by_part: Counter[str] = Counter()
        for file, text in texts.items():
            by_part[file.relative_to(folder).parts[0].removesuffix(".py")] += lines_of_code(text)
        for part, count in by_part.most_common():
            print(f"{count:8,}  {folder.name}/{part}")
        modules = [file for file in texts if file.name != "__init__.py"]
        print(f"{len(modules):8,}  modules beside {len(texts) - len(modules)} __init__.py")
        total += by_part.total()
        print(f"{by_part.total():8,}  lines of code in {folder.name}")
        print(f"{sum(map(import_lines, texts.values())):8,}  lines that import")
        print(f"{longest_chain(imported(folder)):8,}  files in the longest chain of imports")
    if len(folders) > 1:
        print(f"{total:8,}  lines of code in all")


if __name__ == "__main__":
    main(
        [Path(name) for name in sys.argv[1:]]
        or sorted(path.parent for path in (ROOT / "src").glob("*/__init__.py"))
    )
