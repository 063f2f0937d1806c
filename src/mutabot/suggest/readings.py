"""What could be read at the end of a test, as the project itself can read it.

Three ways: the functions by which the tests read already, what the vocabulary's probes and readings name, and
what the test has at hand.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator

from mutabot.frozen import frozen
from mutabot.model import Operation

from .place import PlaceInTest
from .project import ImportedName, ProjectFiles, name_in

#: from the one that a reader of the tests knows best
ORACLE, PROBE, HAND = 0, 1, 2


@frozen
class ReadExpression:
    """An expression that reads something.

    Attributes:
        text: the expression.
        way: ``ORACLE``, ``PROBE`` or ``HAND``.
        tolerance: greatest difference of equal worlds in it.
        needs: imports that it needs.
        uses: names of the place that it uses.
    """

    text: str
    way: int
    tolerance: float
    needs: tuple[str, ...] = ()
    uses: tuple[str, ...] = ()


def readings_at(project: ProjectFiles, place: PlaceInTest) -> list[ReadExpression]:
    """The readings of a place, those first by which the tests read already."""
    module = project.module(place.file)
    assert module is not None
    vocabulary = project.request.vocabulary
    coarse = max((probe.tolerance for probe in vocabulary.probes), default=1e-6)
    found = [*_by_oracle(project, place, module, coarse)]
    for probe in vocabulary.probes:
        name = _module_level(module, probe.target, place) if not probe.owner else None
        if name is not None:
            texts = (f"{name.text}()", name.text)
            found += [ReadExpression(text, PROBE, probe.tolerance, _needs(name)) for text in texts]
    for operation in vocabulary.operations:
        for text, name in _reading_calls(operation, module, place):
            found.append(ReadExpression(text, PROBE, coarse, _needs(name)))
    return list({one.text: one for one in reversed(found)}.values())[::-1]


def of_objects(project: ProjectFiles) -> list[tuple[str, float]]:
    """Readings of objects, ``module:Class.name``, each with its tolerance."""
    vocabulary = project.request.vocabulary
    coarse = max((probe.tolerance for probe in vocabulary.probes), default=1e-6)
    found = {probe.target: probe.tolerance for probe in vocabulary.probes if probe.owner}
    for one in vocabulary.operations:
        if _only_reads(one) and not one.patterns and "." in one.qualname:
            found.setdefault(one.target, coarse)
    return list(found.items())


def _by_oracle(
    project: ProjectFiles, place: PlaceInTest, module: ast.Module, tolerance: float
) -> Iterator[ReadExpression]:
    """The oracle's functions, where all that they need is at hand under the same name."""
    for file in project.python_files(project.request.configuration.oracle):
        oracle = project.module(file)
        for node in oracle.body if oracle is not None and file != place.file else ():
            if not isinstance(node, ast.FunctionDef) or node.name.startswith(("_", "test")):
                continue
            given = node.args
            needed = [one.arg for one in (*given.posonlyargs, *given.args)]
            needed = needed[: len(needed) - len(given.defaults)]
            strict = any(default is None for default in given.kw_defaults)
            if strict or not set(needed) <= set(place.names) or node.decorator_list:
                continue
            name = name_in(module, project.import_name(file), node.name, place.names)
            yield ReadExpression(
                f"{name.text}({', '.join(needed)})", ORACLE, tolerance, _needs(name), tuple(needed)
            )


def _module_level(module: ast.Module, target: str, place: PlaceInTest) -> ImportedName | None:
    where, _, attribute = target.partition(":")
    return name_in(module, where, attribute, place.names) if attribute else None


def _only_reads(operation: Operation) -> bool:
    is_callable = operation.named is None and operation.kind is None
    return is_callable and not operation.command and not operation.arguments


def _reading_calls(
    operation: Operation, module: ast.Module, place: PlaceInTest
) -> Iterator[tuple[str, ImportedName]]:
    """Calls that only read: an operation without arguments, or one that is told by a text what to read."""
    if not _only_reads(operation) or "." in operation.qualname:
        return
    name = _module_level(module, operation.target, place)
    if name is None:
        return
    if not operation.patterns:
        yield f"{name.text}()", name
    if operation.message and operation.message.isidentifier():
        for pattern in operation.patterns:
            if pattern.command is not True and pattern.notation and not pattern.fields and not pattern.when:
                yield f'{name.text}({operation.message}="{pattern.notation}")', name


def _needs(name: ImportedName) -> tuple[str, ...]:
    return (name.needs,) if name.needs else ()
