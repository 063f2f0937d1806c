"""Finds the functions of a file that differ, if nothing else does: a running process can replace these.

Everything outside of functions is carried out while the file is imported; if that differs, a process that has
imported the file cannot become the mutant any more. The same holds for what others may have looked at: a
function's parameters, its docstring, and whether it is a generator.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from types import CodeType

#: its locals are its own, as those of functions are, and those of class bodies are not
_OPTIMIZED = 1
#: generators and coroutines, also asynchronous generators
_SUSPENDED = 0x20 | 0x80 | 0x200


@dataclass(frozen=True, slots=True)
class ChangedFunction:
    """A function that differs.

    Attributes:
        name: qualified name.
        old, new: its first line before and after, that of its first decorator if it has one.
    """

    name: str
    old: int
    new: int


def changed_functions(before: bytes, after: bytes, path: str) -> tuple[ChangedFunction, ...] | None:
    """Return the functions that differ; None if anything else differs.

    Raises SyntaxError or ValueError if one of the texts is no Python.
    """
    old, new = (compile(text, path, "exec", dont_inherit=True) for text in (before, after))
    found = list[ChangedFunction]()
    return tuple(found) if _compare(old, new, found) else None


def codes_of(code: CodeType) -> Iterator[CodeType]:
    """Yield a code object and all within it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from codes_of(constant)


def first_statement(tree: ast.Module, function: ChangedFunction) -> ast.stmt | None:
    """Return the first statement that a function executes; None if it cannot be determined."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            first = min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
            if first == function.old and node.name == function.name.rpartition(".")[2]:
                has_text = ast.get_docstring(node, clean=False) is not None
                return next(iter(node.body[has_text:]), None)
    return None


def extent_of(node: ast.stmt) -> tuple[int, int, int, int]:
    """Return the extent of a statement."""
    return node.lineno, node.col_offset, node.end_lineno or node.lineno, node.end_col_offset or 0


def _compare(old: CodeType, new: CodeType, found: list[ChangedFunction]) -> bool:
    """Compare code that an import executes, and collect the functions in it that differ."""
    if not _has_same_code(old, new):
        return False
    for before, after in zip(_within(old), _within(new), strict=True):
        if not before.co_flags & _OPTIMIZED:  # the body of a class
            if not _compare(before, after, found):
                return False
        elif not _is_same(before, after):
            if not _can_replace(before, after):
                return False
            found.append(ChangedFunction(before.co_qualname, before.co_firstlineno, after.co_firstlineno))
    return True


def _is_same(old: CodeType, new: CodeType) -> bool:
    """Return whether two functions do the same, with everything defined in them."""
    pairs = zip(_within(old), _within(new), strict=False)
    return _has_same_code(old, new) and all(_is_same(before, after) for before, after in pairs)


def _can_replace(old: CodeType, new: CodeType) -> bool:
    """Return whether a function may get the other's code without a difference that can be observed."""
    is_named = not old.co_name.startswith("<")
    is_plain = not old.co_flags & _SUSPENDED  # one that was made before goes on with the code that it has
    return is_named and is_plain and _head(old) == _head(new) and old.co_freevars == new.co_freevars


def _head(code: CodeType) -> tuple[object, ...]:
    count = code.co_argcount + code.co_kwonlyargcount + bool(code.co_flags & 4) + bool(code.co_flags & 8)
    text = code.co_consts[0] if code.co_consts and isinstance(code.co_consts[0], str) else None
    parameters = code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_varnames[:count]
    return code.co_name, code.co_qualname, code.co_flags, text, parameters


def _has_same_code(old: CodeType, new: CodeType) -> bool:
    """Return whether two pieces of code do the same, except for definitions in them; lines do not count."""
    return _content(old) == _content(new)


def _content(code: CodeType) -> tuple[object, ...]:
    constants = tuple(
        "code" if isinstance(constant, CodeType) else _typed(constant) for constant in code.co_consts
    )
    names = code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars
    inner = tuple(inner_code.co_name for inner_code in _within(code))
    counts = code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags
    return code.co_name, code.co_code, code.co_exceptiontable, constants, names, inner, counts


def _typed(constant: object) -> tuple[str, str]:
    """Return a constant so that 1, 1.0 and True differ, and 0.0 and -0.0."""
    if isinstance(constant, frozenset):
        return "frozenset", repr(sorted(map(_typed, constant)))
    if isinstance(constant, tuple):
        return "tuple", repr([_typed(element) for element in constant])
    return type(constant).__name__, repr(constant)


def _within(code: CodeType) -> list[CodeType]:
    return [constant for constant in code.co_consts if isinstance(constant, CodeType)]
