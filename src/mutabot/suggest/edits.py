"""Additions put into the texts of test files, with all that they need."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import libcst as cst
from libcst.codemod import CodemodContext
from libcst.codemod.visitors import AddImportsVisitor

from .place import OTHER, Addition, PlaceInTest
from .project import ProjectFiles

_AT_END = "from mutabot.runtime.observation.noted import at_end as _mutabot_at_end"


def edited(project: ProjectFiles, additions: Iterable[Addition]) -> dict[str, str]:
    """The new texts of the files with these additions, by file.

    What is added to tests that another tool makes runs beside mutabot alone.
    """
    by_file: dict[str, list[Addition]] = {}
    for one in additions:
        by_file.setdefault(one.place.file, []).append(one)
    return {file: _edited(project.text(file), found) for file, found in by_file.items()}


def _edited(text: str, additions: Sequence[Addition]) -> str:
    imports = [line for one in additions for line in one.imports]
    written = [one for one in additions if one.place.style != OTHER]
    made = dict.fromkeys(one.place for one in additions if one.place.style == OTHER)
    lines = [_AT_END] if made else []
    for number, place in enumerate(made):
        lines += _around(place, [one for one in additions if one.place == place], number)
    context = CodemodContext()
    for line in imports:
        _, source, *names = line.split()
        AddImportsVisitor.add_needed_import(context, source, names[-1] if names else None)
    module = cst.parse_module(text)
    module = module.with_changes(body=_with_ends(module.body, written))
    changed = AddImportsVisitor(context).transform_module(module)
    code, newline = changed.code, changed.default_newline
    if lines:
        code += "" if code.endswith(newline) else newline
        code += newline.join([*lines, ""])
    return code


def _around(place: PlaceInTest, additions: Sequence[Addition], number: int) -> list[str]:
    """What follows a test of which the file has no function that could be added to."""
    (test,) = place.path
    uses = dict.fromkeys(use for one in additions for use in one.uses)
    return [
        "",
        f"def _mutabot_end_{number}(value_of):",
        *(f"    {use} = value_of({use!r})" for use in uses),
        *(f"    {line}" for one in additions for line in one.lines),
        "",
        f"{test} = _mutabot_at_end({test}, _mutabot_end_{number})",
    ]


def _with_ends(
    body: Sequence[cst.CSTNode], additions: Sequence[Addition], path: tuple[str, ...] = ()
) -> list[cst.CSTNode]:
    """The statements of a module or class, with additions at the ends of its functions."""
    found: list[cst.CSTNode] = []
    for one in body:
        changed = one
        if isinstance(one, cst.ClassDef):
            inner = _with_ends(one.body.body, additions, (*path, one.name.value))
            changed = one.with_changes(body=one.body.with_changes(body=inner))
        elif isinstance(one, cst.FunctionDef):
            here = [each for each in additions if each.place.path == (*path, one.name.value)]
            changed = _with_end(one, here) if here else one
        found.append(changed)
    return found


def _with_end(function: cst.FunctionDef, additions: Sequence[Addition]) -> cst.FunctionDef:
    body = [*function.body.body]
    last = body[-1]
    returns = isinstance(last, cst.SimpleStatementLine) and isinstance(last.body[-1], cst.Return)
    end = len(body) - 1 if returns else len(body)
    body[end:end] = cst.parse_module("".join(f"{line}\n" for one in additions for line in one.lines)).body
    return function.with_changes(body=function.body.with_changes(body=body))
