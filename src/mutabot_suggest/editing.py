"""Adds statements to tests and returns the new texts of their files.

Nothing is ever written to the project itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import libcst as cst

from .imports import with_imports
from .project import OTHER, UNITTEST, PlaceInTest, SuiteFiles


@dataclass(frozen=True, slots=True)
class Addition:
    """Statements to add to a test.

    Attributes:
        place: the test.
        lines: statements.
        uses: names of the place that the statements use.
        imports: what they need.
        after: the name behind whose binding they stand; empty for the end of the test.
    """

    place: PlaceInTest
    lines: tuple[str, ...]
    uses: tuple[str, ...] = ()
    imports: tuple[str, ...] = ()
    after: str = ""


def within(style: str, text: str, value: str, tolerance: str) -> str:
    """Return the statement that checks that ``text`` is ``value`` within ``tolerance``."""
    if style == UNITTEST:
        return f"self.assertAlmostEqual({text}, {value}, delta={tolerance})"
    return f"assert {text} == pytest.approx({value}, abs={tolerance})"


#: values that have statements of their own: the method of ``TestCase``, and what pytest asserts
_PLAIN = {
    "True": ("assertTrue", "{}"),
    "False": ("assertFalse", "not {}"),
    "None": ("assertIsNone", "{} is None"),
}


def equal(style: str, text: str, value: str) -> str:
    """Return the statement that checks that ``text`` equals ``value``."""
    if value in _PLAIN:
        method, expression = _PLAIN[value]
        return f"self.{method}({text})" if style == UNITTEST else f"assert {expression.format(text)}"
    return f"self.assertEqual({text}, {value})" if style == UNITTEST else f"assert {text} == {value}"


_AROUND = "from mutabot_suggest.recorder import around as _mutabot_around"


def edited(
    project: SuiteFiles, additions: Iterable[Addition], texts: Mapping[str, str] | None = None
) -> dict[str, str]:
    """Return the new texts of the files with these additions, by file.

    What is added to tests that another tool makes runs beside mutabot alone. ``texts``: what files have
    already instead of their own.
    """
    by_file: dict[str, list[Addition]] = {}
    for addition in additions:
        by_file.setdefault(addition.place.file, []).append(addition)
    found = dict(texts or {})
    for file, added in by_file.items():
        text = found.get(file) or project.text(file)
        found[file] = _edited(project, file, text, added)
    return found


def _edited(project: SuiteFiles, file: str, text: str, additions: Sequence[Addition]) -> str:
    imports = [line for addition in additions for line in addition.imports]
    written = [addition for addition in additions if addition.place.style != OTHER]
    made = dict.fromkeys(addition.place for addition in additions if addition.place.style == OTHER)
    lines = [_AROUND] if made else []
    for number, place in enumerate(made):
        early = project.classes_of(file)
        lines += _around(
            place, [addition for addition in additions if addition.place == place], number, early
        )
    module = cst.parse_module(text)
    changed = module.with_changes(body=_with_ends(module.body, written))
    code, newline = with_imports(changed.code, imports, project.own_modules), changed.default_newline
    if lines:
        code += "" if code.endswith(newline) else newline
        code += newline.join([*lines, ""])
    return code


def _around(
    place: PlaceInTest, additions: Sequence[Addition], number: int, early: Mapping[str, str]
) -> list[str]:
    """Return the statements for a test without a function of its own in the file."""
    (test,) = place.path
    first = [addition for addition in additions if addition.after]
    watched = {name: early[name] for addition in first for name in addition.uses if name in early}
    begin, end = f"_mutabot_begin_{number}", f"_mutabot_end_{number}"
    return [
        *_function(begin, first),
        *_function(end, [addition for addition in additions if not addition.after]),
        "",
        f"{test} = _mutabot_around({test}, {begin}, {end}, {watched!r})",
    ]


def _function(name: str, additions: Sequence[Addition]) -> list[str]:
    uses = dict.fromkeys(use for addition in additions for use in addition.uses)
    return [
        "",
        f"def {name}(value_of):",
        "    pass",
        *(f"    {use} = value_of({use!r})" for use in uses),
        *(f"    {line}" for addition in additions for text in addition.lines for line in text.splitlines()),
    ]


def _with_ends(
    body: Sequence[cst.CSTNode], additions: Sequence[Addition], path: tuple[str, ...] = ()
) -> list[cst.CSTNode]:
    """Return the statements of a module or class, with additions at the ends of its functions."""
    found: list[cst.CSTNode] = []
    for statement in body:
        changed = statement
        if isinstance(statement, cst.ClassDef):
            inner = _with_ends(statement.body.body, additions, (*path, statement.name.value))
            changed = statement.with_changes(body=statement.body.with_changes(body=inner))
        elif isinstance(statement, cst.FunctionDef):
            here = [each for each in additions if each.place.path == (*path, statement.name.value)]
            changed = _with_end(statement, here) if here else statement
        found.append(changed)
    return found


def _with_end(function: cst.FunctionDef, additions: Sequence[Addition]) -> cst.FunctionDef:
    body = [*function.body.body]
    last = body[-1]
    returns = isinstance(last, cst.SimpleStatementLine) and isinstance(last.body[-1], cst.Return)
    end = len(body) - 1 if returns else len(body)
    body[end:end] = _statements(addition for addition in additions if not addition.after)
    for name in dict.fromkeys(addition.after for addition in additions if addition.after):
        at = _bound_at(body, name)
        body[at:at] = _statements(addition for addition in additions if addition.after == name)
    return function.with_changes(body=function.body.with_changes(body=body))


def _statements(additions: Iterable[Addition]) -> Sequence[cst.CSTNode]:
    return cst.parse_module("".join(f"{line}\n" for addition in additions for line in addition.lines)).body


def _bound_at(body: Sequence[cst.CSTNode], name: str) -> int:
    """Return the index of the statement after the one that binds a name; 0 for an argument."""
    for number, statement in enumerate(body):
        match statement:
            case cst.SimpleStatementLine(body=[cst.Assign(targets=[cst.AssignTarget(cst.Name(value))])]) if (
                value == name
            ):
                return number + 1
            case cst.SimpleStatementLine(body=[cst.AnnAssign(target=cst.Name(value))]) if value == name:
                return number + 1
    match body[0] if body else None:
        case cst.SimpleStatementLine(body=[cst.Expr(cst.SimpleString() | cst.ConcatenatedString())]):
            return 1
    return 0
