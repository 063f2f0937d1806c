"""The front end for Python: positions of calls, from the running instruction and from the source."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from importlib.util import decode_source
from keyword import kwlist
from types import CodeType, FrameType
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from mutabot.model.mutant import Extent


_Node = TypeVar("_Node", bound=ast.AST)
_TEXT_LIMIT = 60
_TEXTS = r"""[rRbBfFuU]{0,2}(?:"{3}[^]*?"{3}|'{3}[^]*?'{3}|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')"""
_HIGHLIGHTED = rf"({_TEXTS})|(#[^\n]*)|\b({'|'.join(kwlist)})\b"
#: code objects that are part of the function around them
_COMPREHENSIONS = tuple(f".<locals>.<{kind}>" for kind in ("listcomp", "setcomp", "dictcomp", "genexpr"))


class Python:
    """The front end for Python."""

    suffixes = (".py",)
    highlighting = _HIGHLIGHTED, "g"

    def text_of(self, content: bytes) -> str:
        """Return the text of a file, by its encoding declaration and with newlines as Python reads them."""
        return decode_source(content)

    def names(self, source: str) -> Mapping[Extent, tuple[str, int]]:
        """Return names of all expressions: a call by the text of its callee, all others by their own.

        What a ``for`` or ``with`` does by itself has the place of the whole statement up to Python 3.12.
        What is looked up on a later line begins there.
        """
        names: dict[Extent, tuple[str, int]] = {}
        tree = ast.parse(source)
        _number(tree, source.encode().splitlines(keepends=True), names)
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                names.setdefault(_definition(node), (f"def {node.name}", 1))
            elif isinstance(node, ast.Lambda):
                names.setdefault((node.lineno, 0, node.lineno, 0), ("lambda", 1))
            elif isinstance(node, ast.For | ast.AsyncFor):
                text, occurrence = names[extent_of(node.iter)]
                names.setdefault(extent_of(node), (f"for {text}", occurrence))
            elif isinstance(node, ast.With | ast.AsyncWith):
                text, occurrence = names[extent_of(node.items[0].context_expr)]
                names.setdefault(extent_of(node), (f"with {text}", occurrence))
            elif isinstance(node, ast.Call | ast.Attribute):
                names.setdefault(_looked_up(node), names[extent_of(node)])
        return names

    def file_of(self, frame: FrameType) -> str | None:
        """Return the file of the frame's code; every frame is one of Python."""
        return frame.f_code.co_filename

    def position_of(self, frame: FrameType) -> tuple[Extent, str]:
        """Return the position of the running instruction."""
        return self.position_at(frame.f_code, frame.f_lasti)

    def position_at(self, code: CodeType, instruction: int) -> tuple[Extent, str]:
        """Return the position of an instruction of the code."""
        line, end_line, column, end_column = list(code.co_positions())[instruction // 2]
        first = line or code.co_firstlineno
        return ((first, column or 0, end_line or first, end_column or 0), function_of(code))

    def definition_of(self, code: CodeType) -> tuple[Extent, str]:
        """Return the position of a function's definition: its first line, or that of its first decorator."""
        first = code.co_firstlineno
        return ((first, 0, first, 0), code.co_qualname)


FRONT_END = Python()


def extent_of(node: ast.expr | ast.stmt) -> Extent:
    """Return the extent of a node in the source."""
    return (node.lineno, node.col_offset, node.end_lineno or node.lineno, node.end_col_offset or 0)


def head_size(body: Sequence[ast.stmt]) -> int:
    """Return how many statements must stay first in a body: docstring and imports from ``__future__``."""
    has_text = bool(body) and isinstance(body[0], ast.Expr) and isinstance(body[0].value, ast.Constant)
    size = int(has_text)
    while size < len(body) and getattr(body[size], "module", None) == "__future__":
        size += 1
    return size


def placed(made: _Node, place: ast.AST) -> _Node:
    """Return a new node at the position of another; parts that have a position keep it."""
    ast.copy_location(made, place)
    for part in ast.iter_child_nodes(made):
        if isinstance(part, ast.expr | ast.stmt | ast.ExceptHandler) and not hasattr(part, "lineno"):
            placed(part, place)
    return made


def function_of(code: CodeType) -> str:
    """Return the function that contains the code; comprehensions are part of the function around them."""
    function = code.co_qualname
    for suffix in _COMPREHENSIONS:
        function = function.removesuffix(suffix)
    return function


def _definition(node: ast.FunctionDef | ast.AsyncFunctionDef) -> Extent:
    """Return what ``definition_of`` returns for the function's code."""
    first = min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
    return (first, 0, first, 0)


def _looked_up(node: ast.Call | ast.Attribute) -> Extent:
    """Return where the interpreter looks a name up: a name on a later line than what has it stands alone."""
    named = node.func if isinstance(node, ast.Call) else node
    line, column, end_line, end_column = extent_of(named)
    if isinstance(named, ast.Attribute) and line != end_line:
        line, column = end_line, end_column - len(named.attr)  # it counts characters here, not bytes
    return (line, column, *extent_of(node)[2:])


def _number(tree: ast.Module, lines: list[bytes], names: dict[Extent, tuple[str, int]]) -> None:
    for scope in _scopes(tree):
        # a call and its callee look alike but are different things to hit
        counts: dict[tuple[type, str], int] = {}
        for node in sorted(_expressions(scope), key=extent_of):
            text = _text(node, lines)
            count = counts[type(node), text] = counts.get((type(node), text), 0) + 1
            names[extent_of(node)] = (text, count)


def _scopes(tree: ast.Module) -> list[ast.AST]:
    kinds = (ast.Module, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return [node for node in ast.walk(tree) if isinstance(node, kinds)]


def _expressions(scope: ast.AST) -> list[ast.expr | ast.AugAssign]:
    """Return the expressions of a function, class or module, except those of functions and classes inside.

    An assignment such as ``+=`` counts as one, since it can be a call.

    Decorators and default arguments run in the scope around the function they belong to.
    """
    found: list[ast.expr | ast.AugAssign] = []
    waiting: list[ast.AST] = list(_own(scope))
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            waiting.extend(outer_of(node))
            continue
        if isinstance(node, ast.expr | ast.AugAssign):
            found.append(node)
        waiting.extend(ast.iter_child_nodes(node))
    return found


def _own(scope: ast.AST) -> list[ast.AST]:
    outer = {id(node) for node in outer_of(scope)}
    return [node for node in ast.iter_child_nodes(scope) if id(node) not in outer]


def outer_of(node: ast.AST) -> list[ast.AST]:
    """Return the parts of a function or class that are evaluated in the scope around it."""
    if isinstance(node, ast.ClassDef):
        return [*node.decorator_list, *node.bases, *(keyword.value for keyword in node.keywords)]
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
        defaults = [
            default for default in (*node.args.defaults, *node.args.kw_defaults) if default is not None
        ]
        return [*([] if isinstance(node, ast.Lambda) else node.decorator_list), *defaults]
    return []


def _text(node: ast.expr | ast.stmt, lines: list[bytes]) -> str:
    callee = node.func if isinstance(node, ast.Call) else node
    text = " ".join(_segment(callee, lines).replace("\\\n", " ").split())
    return text if len(text) <= _TEXT_LIMIT else text[: _TEXT_LIMIT - 1] + "…"


def _segment(node: ast.expr | ast.stmt, lines: list[bytes]) -> str:
    first, start, last, end = extent_of(node)
    if first == last:
        return lines[first - 1][start:end].decode()
    middle = b"".join(lines[first : last - 1])
    return (lines[first - 1][start:] + middle + lines[last - 1][:end]).decode()
