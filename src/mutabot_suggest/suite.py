"""The suite's own checks: which values they compare, in which form, and with which tolerance.

A check that is suggested takes its predicate, its constants and its tolerance from here.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field

from .forms import ACTUAL, EXPECTED, TOLERANCE, SuiteCheck, check_of, is_clock, is_number, near_of, rename
from .project import (
    UNITTEST,
    PlaceInTest,
    SuiteFiles,
    TestFunctionNode,
    awaits,
    function_of,
    name_in,
    text_of,
    top_names,
)

#: how the keys begin under which is noted what checks compared, and which other checks hold
COMPARED, HELD = "@", "?"
#: checks of other tests that are tried in one test at most
_MOST = 40


@dataclass(frozen=True, slots=True)
class ReusableCheck:
    """A check of another test or step that can also be evaluated at the end of a test.

    Attributes:
        key: under which is noted whether it holds.
        statement: as it stands there.
        needs: imports.
        near: the check that it is, if it is near something; its tolerance may be at hand there only.
        function: where it stands.
    """

    key: str
    statement: str
    needs: tuple[str, ...]
    near: SuiteCheck | None
    function: str

    @property
    def lacks_tolerance(self) -> bool:
        """Whether its tolerance is a local name of its own function."""
        return (
            self.near is not None and self.near.tolerance.isidentifier() and not self.near.tolerance.isupper()
        )

    def written(self, tolerance: float | None) -> str:
        """Return the statement as it is added; ``tolerance`` is its value in the original test."""
        if self.near is None or tolerance is None or not self.lacks_tolerance:
            return self.statement
        return rename(self.statement, self.near.tolerance, repr(tolerance))


@dataclass(slots=True)
class SuiteChecks:
    """The checks of a project's tests."""

    project: SuiteFiles
    checks: list[SuiteCheck] = field(default_factory=list)

    @classmethod
    def of(cls, project: SuiteFiles) -> SuiteChecks:
        """Find the checks in all files except the program's."""
        suite = cls(project)
        for file in project.suite_files:
            for name, node in suite._statements(file):
                found = near_of(node)
                if found is not None:
                    suite.checks.append(check_of(f"{COMPARED}{len(suite.checks)}", file, node, found, name))
        return suite

    def with_recording(self, file: str, text: str) -> str:
        """Return the text of a file in which checks record what they compare."""
        marks: list[tuple[int, int, str]] = []
        starts = _starts(text)
        for check in self.checks:
            if check.file == file:
                roles = ("actual", "expected", "tolerance")
                for node, role in zip(check.nodes, roles, strict=True):
                    call = (
                        f'__import__("mutabot_suggest.recorder").recorder.compared("{check.key}", "{role}", '
                    )
                    begin = starts[node.lineno - 1] + node.col_offset
                    end = starts[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0)
                    marks += [(begin, 1, call), (end, 0, ")")]
        data = text.encode()
        for at, _, more in sorted(marks, reverse=True):
            data = data[:at] + more.encode() + data[at:]
        return data.decode()

    def constant(self, place: PlaceInTest, file: str, text: str) -> tuple[str, ...] | None:
        """Return the imports that an expression of a file's constants needs at a place; else None."""
        names = (
            {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)} if text else set()
        )
        if not names or not all(name.isupper() for name in names) or names & {*place.names}:
            return None
        return self._imports(place, file, names)

    def constants(self, file: str) -> Iterator[tuple[str, float]]:
        """Yield the expressions and values of the items of a file's constants."""
        module = self.project.module(file)
        for node in module.body if module is not None else ():
            targets = node.targets[0] if isinstance(node, ast.Assign) else None
            for target, value in assigned(targets, node.value if isinstance(node, ast.Assign) else None):
                try:
                    items = ast.literal_eval(value)
                except ValueError:
                    continue
                if target.isupper() and isinstance(items, tuple | list):
                    yield from (
                        (f"{target}[{number}]", item) for number, item in enumerate(items) if is_number(item)
                    )

    def needs_of_form(self, place: PlaceInTest, check: SuiteCheck) -> tuple[str, ...] | None:
        """Return the imports that a check of this form needs at a place; None if it is not possible there."""
        names = {node.id for node in ast.walk(ast.parse(check.form)) if isinstance(node, ast.Name)}
        names -= {ACTUAL, EXPECTED, TOLERANCE, *dir(builtins)}
        if ("self" in names) != (place.style == UNITTEST):
            return None
        return self._imports(place, check.file, names - {"self"})

    def _imports(self, place: PlaceInTest, file: str, names: Collection[str]) -> tuple[str, ...] | None:
        """Return the imports that give a place these names of a file; None if one is impossible."""
        module, other = self.project.module(place.file), self.project.module(file)
        if module is None or other is None:
            return None
        needs = []
        for name in sorted(names):
            if file == place.file and name in top_names(module):
                continue
            line = _import_of(other, name)
            if line is None or (name in top_names(module) and _import_of(module, name) != line):
                return None
            needs.append(line)
        return tuple(needs)

    def watched(self, place: PlaceInTest, name: str) -> list[tuple[str, tuple[str, ...]]]:
        """Return the readings in the suite's monitored conditions for an object that a test calls ``name``.

        Each is a call of a function with this object, with the imports that it needs.
        """
        module = self.project.module(place.file)
        found: dict[str, tuple[str, ...]] = {}
        for file in self.project.suite_files if module is not None else ():
            other = self.project.module(file)
            defined = (
                {statement.name for statement in other.body if isinstance(statement, TestFunctionNode)}
                if other
                else set()
            )
            for call in (node for node in ast.walk(other) if isinstance(node, ast.Call)) if other else ():
                if isinstance(call.func, ast.Attribute) and call.func.attr == "always":
                    for inner in (node for node in ast.walk(call) if isinstance(node, ast.Call)):
                        reads = isinstance(inner.func, ast.Name) and inner.func.id in defined
                        if (
                            reads
                            and [ast.unparse(argument) for argument in inner.args] == [name]
                            and module is not None
                        ):
                            home = self.project.import_name(file)
                            text, needs = ast.unparse(inner.func), tuple[str, ...]()
                            if file != place.file:
                                text, needs = name_in(module, home, text, place.names)
                            found[f"{text}({name})"] = needs
        return list(found.items())

    def reusable_checks(self, place: PlaceInTest) -> list[ReusableCheck]:
        """Return the checks of other tests whose names are all available in a test."""
        module = self.project.module(place.file)
        own = function_of(module, place)
        there = {text_of(inner) for inner in ast.walk(own) if isinstance(inner, ast.stmt)} if own else set()
        found: dict[str, ReusableCheck] = {}
        for file in self.project.suite_files:
            other = self.project.module(file)
            helpers = _checking(other) if other is not None else set()
            for name, node in self._statements(file):
                statement = text_of(node)
                is_own = own is not None and name == own.name
                if statement in there or statement in found or is_own or name in helpers:
                    continue
                if other is not None and _reads_clock(other, node):
                    continue  # another test's deadline
                if awaits(node):
                    continue
                near = next(
                    (check for check in self.checks if check.file == file and _is_at(check, node)), None
                )
                needs = self._needs(place, file, node, near)
                if needs is not None and not self._acts(file, node):
                    key = f"{HELD}{len(found)}"
                    found[statement] = ReusableCheck(key, statement, needs, near, name)
        return list(found.values())[:_MOST]

    def _statements(self, file: str) -> Iterator[tuple[str, ast.stmt]]:
        """Yield the checking statements of a file's functions, each with the function's name."""
        module = self.project.module(file)
        if module is None:
            return
        helpers = _checking(module) | self._imported(module)
        for function in (inner for inner in ast.walk(module) if isinstance(inner, TestFunctionNode)):
            for node in ast.walk(function):
                if isinstance(node, ast.Assert):
                    yield function.name, ast.Assert(node.test) if node.msg is not None else node
                elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
                    name = ast.unparse(node.value.func)
                    if name in helpers or name.startswith("self.assert") or ".assert_allclose" in name:
                        yield function.name, node

    def _imported(self, module: ast.Module) -> set[str]:
        """Return the checking functions that a file imports from other files of the suite."""
        checking = {
            (self.project.import_name(file).rpartition(".")[2], name)
            for file in self.project.suite_files
            if (other := self.project.module(file)) is not None
            for name in _checking(other)
        }
        return {
            alias.name
            for node in module.body
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
            if ((node.module or "").rpartition(".")[2], alias.name) in checking
        }

    def _needs(
        self, place: PlaceInTest, file: str, node: ast.stmt, near: SuiteCheck | None
    ) -> tuple[str, ...] | None:
        """Return the imports that a statement of a file needs at a place; None if a name is unavailable."""
        module, other = self.project.module(place.file), self.project.module(file)
        if module is None or other is None:
            return None
        names = {inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name)}
        stored = (
            inner
            for inner in ast.walk(node)
            if isinstance(inner, ast.Name) and isinstance(inner.ctx, ast.Store)
        )
        names -= {name_node.id for name_node in stored} | {*dir(builtins)}
        if near is not None and near.tolerance.isidentifier() and near.tolerance not in top_names(other):
            names.discard(near.tolerance)
        if "self" in names and place.style != UNITTEST:
            return None
        here = names & {*place.names}
        needs = self._imports(place, file, names - here - {"self"})
        return needs if here or any(isinstance(inner, ast.Call) for inner in ast.walk(node)) else None

    def _acts(self, file: str, node: ast.AST, depth: int = 3) -> bool:
        """Return whether a statement runs the program or commands the robot."""
        module = self.project.module(file)
        program = {
            self.project.import_name(program_file).rpartition(".")[2]
            for program_file in self.project.program_files
        }
        operations = self.project.request.vocabulary.operations
        commands = {operation.last_name for operation in operations if operation.command}
        for call in (inner_call for inner_call in ast.walk(node) if isinstance(inner_call, ast.Call)):
            name = ast.unparse(call.func)
            last, first = name.rpartition(".")[2], name.partition(".")[0]
            line = _import_of(module, first) if module is not None else None
            if last in commands or (line is not None and line.split()[1].rpartition(".")[2] in program):
                return True
            if isinstance(call.func, ast.Name) and module is not None and depth > 0:
                inner = next(
                    (
                        statement
                        for statement in module.body
                        if isinstance(statement, TestFunctionNode) and statement.name == name
                    ),
                    None,
                )
                if inner is not None and any(
                    self._acts(file, statement, depth - 1) for statement in inner.body
                ):
                    return True
        return False


def assigned(target: ast.expr | None, value: ast.expr | None) -> Iterator[tuple[str, ast.expr]]:
    """Yield the names that an assignment binds, with their values: ``A, B = 1, 2`` gives two."""
    if isinstance(target, ast.Name) and value is not None:
        yield target.id, value
    elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        for first, second in zip(target.elts, value.elts, strict=False):
            yield from assigned(first, second)


def _is_at(check: SuiteCheck, node: ast.stmt) -> bool:
    return any(inner is check.nodes[0] for inner in ast.walk(node))


def _reads_clock(module: ast.Module, check: ast.stmt) -> bool:
    """Return whether a check, or an assertion of its file's function that it calls, looks at a time."""
    for inner in ast.walk(check):
        name = (
            inner.id
            if isinstance(inner, ast.Name)
            else inner.attr
            if isinstance(inner, ast.Attribute)
            else ""
        )
        if name and not name.isupper() and is_clock(name):
            return True
    called = {
        inner.func.id
        for inner in ast.walk(check)
        if isinstance(inner, ast.Call) and isinstance(inner.func, ast.Name)
    }
    helpers = (
        statement
        for statement in module.body
        if isinstance(statement, TestFunctionNode) and statement.name in called
    )
    asserted = (part for helper in helpers for part in ast.walk(helper) if isinstance(part, ast.Assert))
    return any(_reads_clock(ast.Module([], []), part) for part in asserted)


def _import_of(module: ast.Module, name: str) -> str | None:
    """Return the statement by which a file imports a name; None if it does not."""
    for node in module.body:
        if isinstance(node, ast.ImportFrom) and not node.level:
            for alias in node.names:
                if (alias.asname or alias.name) == name and alias.asname in (None, alias.name):
                    return f"from {node.module} import {name}"
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name == name and alias.asname is None:
                    return f"import {name}"
    return None


def _starts(text: str) -> list[int]:
    """Return the byte offset at which each line begins."""
    found = [0]
    for line in text.encode().splitlines(keepends=True):
        found.append(found[-1] + len(line))
    return found


def _checking(module: ast.Module) -> set[str]:
    """Return a file's own checking functions that tests call: no tests, fixtures or steps."""
    return {
        statement.name
        for statement in module.body
        if isinstance(statement, TestFunctionNode)
        and not statement.name.startswith("test")
        and not statement.decorator_list
        and any(isinstance(part, ast.Assert) for part in ast.walk(statement))
    }
