"""Where a check can stand, and how the tests there say it.

Three styles: test functions of pytest, methods of ``TestCase``, and tests that another tool makes of
something else, as pytest-bdd does of scenarios. No diff changes the last ones, but checks are tried in them.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Sequence

import libcst as cst
from libcst.codemod import CodemodContext
from libcst.codemod.visitors import AddImportsVisitor

from mutabot.frozen import frozen

from .project import ProjectFiles

Function = ast.FunctionDef | ast.AsyncFunctionDef

PYTEST, UNITTEST, OTHER = "pytest", "unittest", "other"


@frozen
class PlaceInTest:
    """A test at whose end something can be looked at; all parameters of it are one place.

    Attributes:
        style: name of its style.
        file: its module, relative to the project.
        node: its node id without parameters.
        names: what it is given: fixtures and parameters.
    """

    style: str
    file: str
    node: str
    names: tuple[str, ...] = ()

    @property
    def path(self) -> tuple[str, ...]:
        """Its name in its module, below that of its class."""
        return tuple(self.node.split("::")[1:])


@frozen
class Addition:
    """What is added to the end of a test.

    Attributes:
        place: the test.
        lines: statements.
        uses: names of the place that the statements use.
        imports: what they need.
    """

    place: PlaceInTest
    lines: tuple[str, ...]
    uses: tuple[str, ...] = ()
    imports: tuple[str, ...] = ()


def place_of(project: ProjectFiles, test: str) -> PlaceInTest | None:
    """The place of a test by its node id; None if nothing can be added to it."""
    node = test.partition("[")[0]
    file, *path = node.split("::")
    module = project.module(file)
    if module is None or len(path) not in (1, 2):
        return None
    function = functions_of(module, path)
    if len(path) == 1 and (function is None or _is_scenario(function)):
        return PlaceInTest(OTHER, file, node, _given_around(project, file))
    if function is None or not _has_end(function):
        return None
    is_case = len(path) == 2 and _is_test_case(module, path[0])
    return PlaceInTest(UNITTEST if is_case else PYTEST, file, node, _names(function))


def _is_scenario(function: Function) -> bool:
    """Whether it only stands for a scenario of pytest-bdd."""
    called = (ast.unparse(one).partition("(")[0] for one in function.decorator_list)
    return any(one.rpartition(".")[2] == "scenario" for one in called)


def _given_around(project: ProjectFiles, file: str) -> tuple[str, ...]:
    """What fixtures and steps of a test file are given: fixtures, as far as a test has asked for them."""
    modules = (project.module(where) for where in (file, *project.beside(file)))
    functions = [
        node
        for module in modules
        for node in (module.body if module is not None else ())
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.decorator_list
    ]
    return tuple(dict.fromkeys(name for one in functions for name in arguments_of(one)))


def _has_end(function: Function) -> bool:
    """Whether statements can follow: not in a body on the line of its ``def``, nor if it ends by raising."""
    return function.body[0].lineno != function.lineno and not isinstance(function.body[-1], ast.Raise)


def _names(function: Function) -> tuple[str, ...]:
    """Arguments, and what is assigned on the way."""
    assigned = [
        one.id
        for statement in function.body
        for one in ast.walk(statement)
        if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
    ]
    return tuple(dict.fromkeys((*arguments_of(function), *assigned)))


def _is_test_case(module: ast.Module, name: str, depth: int = 5) -> bool:
    owner = next((one for one in module.body if isinstance(one, ast.ClassDef) and one.name == name), None)
    bases = [ast.unparse(one) for one in owner.bases] if owner is not None else []
    return any(
        base.endswith("TestCase") or (depth > 0 and _is_test_case(module, base, depth - 1)) for base in bases
    )


def functions_of(module: ast.Module, path: Sequence[str]) -> Function | None:
    """The function with this qualified name, split at its dots."""
    body: Sequence[ast.stmt] = module.body
    for name in path[:-1]:
        owner = next((one for one in body if isinstance(one, ast.ClassDef) and one.name == name), None)
        if owner is None:
            return None
        body = owner.body
    functions = [one for one in body if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef)]
    return next((one for one in reversed(functions) if one.name == path[-1]), None)


def arguments_of(function: Function) -> tuple[str, ...]:
    """The names of its arguments."""
    given = function.args
    return tuple(one.arg for one in (*given.posonlyargs, *given.args, *given.kwonlyargs))


def within(style: str, text: str, value: str, tolerance: str) -> str:
    """The statement that ``text`` reads ``value`` within ``tolerance``."""
    if style == UNITTEST:
        return f"self.assertAlmostEqual({text}, {value}, delta={tolerance})"
    return f"assert {text} == pytest.approx({value}, abs={tolerance})"


def equal(style: str, text: str, value: str) -> str:
    """The statement that ``text`` reads ``value`` exactly."""
    if style == UNITTEST:
        plain = {
            "True": "self.assertTrue({})",
            "False": "self.assertFalse({})",
            "None": "self.assertIsNone({})",
        }
        return plain.get(value, f"self.assertEqual({{}}, {value})").format(text)
    plain = {"True": f"assert {text}", "False": f"assert not {text}", "None": f"assert {text} is None"}
    return plain.get(value, f"assert {text} == {value}")


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
