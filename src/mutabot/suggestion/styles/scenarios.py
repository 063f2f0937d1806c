"""Feature files: the scenarios in them, their steps, and where a step can be added."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mutabot.suggestion.project import Insertion, Project, imports_of, top_names
from mutabot.suggestion.readings import fixture
from mutabot.suggestion.style import Addition, Function, Place, PlainAsserts, arguments_of

_SCENARIO = re.compile(r"\s*(?:Scenario Outline|Scenario Template|Scenario|Example)\s*:\s*(.*?)\s*$")
_BACKGROUND = re.compile(r"\s*Background\s*:")
_OTHER = re.compile(r"\s*(?:Feature|Rule|Examples|Scenarios)\s*:|\s*@")
_STEP = re.compile(r"(\s*)(Given|When|Then|And|But|\*)\s+(.*?)\s*$")


@dataclass(slots=True)
class Scenario:
    """A scenario.

    Attributes:
        title: as the file has it; empty for a background.
        end: the 1-based line after which a further step comes.
        indent: of its steps.
        steps: keyword and text.
    """

    title: str
    end: int
    indent: str
    steps: list[tuple[str, str]]

    def keyword(self) -> str:
        """With which a further check begins."""
        real = [word for word, _ in self.steps if word not in {"And", "But", "*"}]
        return "And" if real and real[-1] == "Then" else "Then"


def scenarios_in(text: str) -> list[Scenario]:
    """The scenarios of a feature file, with backgrounds as those without a title."""
    found: list[Scenario] = []
    current: Scenario | None = None
    quoted = False
    for number, line in enumerate(text.splitlines(), start=1):
        is_quote = line.strip()[:3] in {'"""', "```"}
        if is_quote or quoted:
            quoted = quoted != is_quote
            if current is not None:
                current.end = number
            continue
        scenario, step = _SCENARIO.match(line), _STEP.match(line)
        if scenario is not None or _BACKGROUND.match(line):
            current = Scenario(scenario[1] if scenario else "", number, "    ", [])
            found.append(current)
        elif _OTHER.match(line):
            current = None
        elif current is not None and step is not None:
            current.indent, current.end = step[1], number
            current.steps.append((step[2], step[3]))
        elif current is not None and line.strip().startswith("|"):
            current.end = number
    return found


_KINDS = ("given", "when", "then", "step")
_FIELD = re.compile(r"\{(\w*)[^}]*\}")
_GROUP = re.compile(r"\(\?P<(\w+)>")
#: what pytest-bdd gives to steps that is no fixture
_GIVEN = {"datatable", "docstring"}


class _Scenarios(PlainAsserts):
    name = "pytest-bdd"

    def place(self, project: Project, node: str) -> Place | None:
        file, *path = node.split("::")
        module = project.module(file)
        if module is None or len(path) != 1:
            return None
        for feature, title in _offered(project, file, module):
            text = project.text(feature)
            for one in scenarios_in(text):
                if one.title and _is_named(path[0], one.title, module, title):
                    background = [other for other in scenarios_in(text) if not other.title]
                    steps = [step for other in (*background, one) for step in other.steps]
                    names = _names(project, file, steps)
                    return Place(self.name, file, node, names, one.title, feature)
        return None

    def at_end(self, project: Project, additions: Sequence[Addition]) -> list[Insertion]:
        file = additions[0].place.file
        module = project.module(file)
        assert module is not None
        found: list[Insertion] = []
        for one in additions:
            scenario = _scenario(project, one.place)
            first = next(other for other in additions if other.place == one.place)
            # a scenario that ended without a check gets one "Then", then "And"
            keyword = scenario.keyword() if one is first else "And"
            step = f"{scenario.indent}{keyword} {one.says}"
            found.append(Insertion(one.place.feature, scenario.end, (step,)))
        end = len(project.lines(file))
        found += [Insertion(file, end, tuple(lines)) for lines in _steps(additions, module)]
        imports = [line for one in additions for line in one.imports]
        imports += ["import pytest"] if any(one.watch is not None for one in additions) else []
        return found + imports_of(file, module, [*imports, "from pytest_bdd import then"])


def _steps(additions: Sequence[Addition], module: ast.Module) -> Iterator[list[str]]:
    """The functions of these steps and what they need, annotated as the file's other steps are."""
    for watch in dict.fromkeys(one.watch for one in additions if one.watch is not None):
        yield ["", "", *fixture(watch, for_all=True)]
    taken = top_names(module)
    annotated = _annotated(module)
    is_typed = any(isinstance(node, ast.FunctionDef) and node.returns is not None for node in module.body)
    for one in additions:
        name = base = _slug(one.says.partition(" is ")[0]) + "_is_as_it_should_be"
        number = 1
        while name in taken:
            number += 1
            name = f"{base}_{number}"
        taken.add(name)
        uses = [*one.uses, *([one.watch.name] if one.watch is not None else [])]
        given = ", ".join(annotated.get(use, use) for use in uses)
        quoted = '"' + one.says.replace("\\", "\\\\").replace('"', '\\"') + '"'
        head = f"def {name}({given}){' -> None' if is_typed else ''}:"
        yield ["", "", f"@then({quoted})", head, *(f"    {line}" for line in one.lines)]


def _annotated(module: ast.Module) -> dict[str, str]:
    """Arguments of the file's functions as they are annotated, by name."""
    return {
        one.arg: f"{one.arg}: {ast.unparse(one.annotation)}"
        for node in module.body
        if isinstance(node, ast.FunctionDef)
        for one in node.args.args
        if one.annotation is not None
    }


def _scenario(project: Project, place: Place) -> Scenario:
    found = scenarios_in(project.text(place.feature))
    return next(one for one in found if one.title == place.title)


def _offered(project: Project, file: str, module: ast.Module) -> Iterator[tuple[str, str | None]]:
    """The feature files that a test file names, each with the title of the one scenario that is meant."""
    for node in ast.walk(module):
        if not (isinstance(node, ast.Call) and node.args):
            continue
        called = ast.unparse(node.func).rpartition(".")[2]
        constants = [one.value for one in node.args if isinstance(one, ast.Constant)]
        texts = [one for one in constants if isinstance(one, str)]
        if called == "scenario" and len(texts) > 1:
            yield from ((one, texts[1]) for one in _features(project, file, texts[0]))
        elif called == "scenarios":
            for text in texts:
                yield from ((one, None) for one in _features(project, file, text))


def _features(project: Project, file: str, name: str) -> list[str]:
    base = (project.root / file).parent
    path = Path(base, name)
    found = sorted(path.rglob("*.feature")) if path.is_dir() else [path]
    return [
        str(one.resolve().relative_to(project.root.resolve()))
        for one in found
        if one.is_file() and one.resolve().is_relative_to(project.root.resolve())
    ]


def _is_named(function: str, title: str, module: ast.Module, only: str | None) -> bool:
    """Whether a test function is that of a scenario: made by its title, or decorated with it."""
    if only is not None and only != title:
        return False
    if only is not None:
        return any(
            isinstance(node, ast.FunctionDef)
            and node.name == function
            and any(title in ast.unparse(one) for one in node.decorator_list)
            for node in module.body
        )
    name = "test_" + re.sub(r"^\d+_*", "", re.sub(r"\W", "", title.replace(" ", "_"))).lower()
    return name in {function, re.sub(r"_\d+$", "", function)}


def _slug(text: str) -> str:
    return re.sub(r"\W+", "_", text).strip("_").lower()


def _names(project: Project, file: str, steps: Sequence[tuple[str, str]]) -> tuple[str, ...]:
    """The fixtures that these steps are given."""
    found: dict[str, None] = {}
    for where in (file, *project.beside(file)):
        module = project.module(where)
        for node in module.body if module is not None else ():
            if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                continue
            for text, fields in _decorated(node):
                if any(re.fullmatch(text, step) for _, step in steps):
                    given = fields | _GIVEN
                    found.update(dict.fromkeys(name for name in arguments_of(node) if name not in given))
    return tuple(found)


def _decorated(function: Function) -> Iterator[tuple[str, set[str]]]:
    """The texts of the steps that a function is, as regular expressions, and the names of their fields."""
    for one in function.decorator_list:
        if not (isinstance(one, ast.Call) and one.args):
            continue
        if ast.unparse(one.func).rpartition(".")[2] not in _KINDS:
            continue
        how, given = "", one.args[0]
        if isinstance(given, ast.Call) and given.args:
            how, given = ast.unparse(given.func).rpartition(".")[2], given.args[0]
        if not (isinstance(given, ast.Constant) and isinstance(given.value, str)):
            continue
        text = given.value
        if how == "re":
            yield text, set(_GROUP.findall(text))
        elif how:
            pieces = [re.escape(piece) for piece in _FIELD.split(text)[::2]]
            yield ".*?".join(pieces), set(_FIELD.findall(text))
        else:
            yield re.escape(text), set()


PYTEST_BDD = _Scenarios()
