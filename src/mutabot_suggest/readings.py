"""The readings available at the ends of tests, and their values in the original and in survivors.

A test can read in three ways: by the functions by which the tests read already, by what the vocabulary's
probes and readings name, and by what it has at hand.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from mutabot.api.processes import Request, Result
from mutabot.api.reports import CampaignRun, MutabotError, MutantResult, Progress
from mutabot.api.values import Operation

from .editing import Addition, edited
from .forms import is_number, rename
from .project import (
    OTHER,
    PlaceInTest,
    SuiteFiles,
    bound_names,
    copy_of,
    function_of,
    name_in,
    text_of,
    top_names,
)
from .suite import COMPARED, HELD, ReusableCheck, SuiteChecks
from .tick_recorder import SIGN

#: from the one that a reader of the tests knows best
ORACLE, PROBE, HAND = 0, 1, 2
#: steps of a reading that are no difference, where it comes in steps: one up or down
_STEPS = 1.5


@dataclass(frozen=True, slots=True)
class ReadExpression:
    """An expression that reads a value.

    Attributes:
        text: the expression.
        way: ``ORACLE``, ``PROBE`` or ``HAND``.
        tolerance: greatest difference of equal worlds in it.
        needs: imports that it needs.
    """

    text: str
    way: int
    tolerance: float
    needs: tuple[str, ...] = ()


def readings_at(project: SuiteFiles, place: PlaceInTest) -> list[ReadExpression]:
    """Return the readings at a place; those that the tests already use come first."""
    module = project.module(place.file)
    assert module is not None
    vocabulary = project.request.vocabulary
    coarse = max((probe.tolerance for probe in vocabulary.probes), default=1e-6)
    found = [*_by_oracle(project, place, module, coarse)]
    found += [ReadExpression(text, ORACLE, coarse) for text in _by_tests(place, module)]
    calls = [
        (probe.target, ["()", ""], probe.tolerance)
        for probe in vocabulary.probes
        if not _is_of_objects(probe.target)
    ]
    calls += [(operation.target, list(_calls(operation)), coarse) for operation in vocabulary.operations]
    for target, endings, tolerance in calls:
        where, _, attribute = target.partition(":")
        if attribute and endings:
            name, needs = name_in(module, where, attribute, place.names)
            found += [ReadExpression(name + ending, PROBE, tolerance, needs) for ending in endings]
    return list({reading.text: reading for reading in reversed(found)}.values())[::-1]


def _is_of_objects(target: str) -> bool:
    """Return whether ``module:qualified.name`` is read from objects of a class."""
    return "." in target.partition(":")[2]


def object_readings(project: SuiteFiles) -> list[tuple[str, float]]:
    """Return the readings of objects, ``module:Class.name``, each with its tolerance."""
    vocabulary = project.request.vocabulary
    coarse = max((probe.tolerance for probe in vocabulary.probes), default=1e-6)
    found = {probe.target: probe.tolerance for probe in vocabulary.probes if _is_of_objects(probe.target)}
    for operation in vocabulary.operations:
        if _only_reads(operation) and not operation.patterns and "." in operation.name:
            found.setdefault(operation.target, coarse)
    return list(found.items())


def _by_oracle(
    project: SuiteFiles, place: PlaceInTest, module: ast.Module, tolerance: float
) -> Iterator[ReadExpression]:
    """Yield calls of the oracle's functions whose arguments are all available under the same names."""
    for file in project.python_files(project.request.configuration.oracle):
        oracle = project.module(file)
        for node in oracle.body if oracle is not None and file != place.file else ():
            if not isinstance(node, ast.FunctionDef) or node.name.startswith(("_", "test")):
                continue
            given = node.args
            needed = [parameter.arg for parameter in (*given.posonlyargs, *given.args)]
            needed = needed[: len(needed) - len(given.defaults)]
            strict = any(default is None for default in given.kw_defaults)
            if strict or not set(needed) <= set(place.names) or node.decorator_list:
                continue
            name, needs = name_in(module, project.import_name(file), node.name, place.names)
            yield ReadExpression(f"{name}({', '.join(needed)})", ORACLE, tolerance, needs)


def _by_tests(place: PlaceInTest, module: ast.Module) -> Iterator[str]:
    """Yield what a file's tests compare, calling at most ``len``, if all its names are available."""
    at_hand = {*place.names, *top_names(module)}
    for compared in (node for node in ast.walk(module) if isinstance(node, ast.Compare)):
        called = [node.func for node in ast.walk(compared) if isinstance(node, ast.Call)]
        for inner in ast.walk(compared):
            parts = [*ast.walk(inner)]
            names = {part.id for part in parts if isinstance(part, ast.Name)} - {"len"}
            calls = {ast.unparse(part.func) for part in parts if isinstance(part, ast.Call)}
            is_plain = (
                inner not in called and calls <= {"len"} and not {ast.Slice, ast.Await} & {*map(type, parts)}
            )
            if isinstance(inner, ast.Attribute | ast.Subscript | ast.Call) and names <= at_hand and is_plain:
                yield text_of(inner)


def _only_reads(operation: Operation) -> bool:
    is_callable = operation.named is None and operation.kind is None
    return is_callable and not operation.command and not operation.arguments


def _calls(operation: Operation) -> Iterator[str]:
    """Yield the argument lists with which a function only reads: none, or a text that selects a value."""
    if not _only_reads(operation) or "." in operation.name:
        return
    if not operation.patterns:
        yield "()"
    if operation.message and operation.message.isidentifier():
        for pattern in operation.patterns:
            if pattern.command is not True and pattern.notation and not pattern.fields and not pattern.when:
                yield f'({operation.message}="{pattern.notation}")'


#: what notes readings in the tests' process, and the probe that carries them out of it
_RECORDER = "mutabot_suggest.recorder"
_PROBE = f"{_RECORDER}:values"
#: what sees the way of a test
_TICK_RECORDER = "mutabot_suggest.tick_recorder"

#: survivors by their ids, each with the rounds in which it is to be killed
Survivors = dict[str, tuple[MutantResult, list[int]]]

#: how the keys begin of what is noted and is no reading
_NO_READINGS = (COMPARED, HELD, SIGN)

#: what was read at the end of one test: expression to number, text or truth value
ValuesRead = Mapping[str, Any]


@dataclass(slots=True)
class Measured:
    """The values of readings.

    Attributes:
        originals: per place, by (round, node id), what the original's tests read.
        mutants: the same per place and mutant id.
        readings: per place, what is known of its readings.
        objects: readings of objects, each with its tolerance.
        reusable_checks: per place, checks of other tests that were asked there as well.
        watched: per place, imports that readings on the way need, by the readings.
        lost: mutants that could not be run there, by their ids, with the reason.
        needs_all: whether all tests were run, as these need what others leave behind.
    """

    originals: dict[PlaceInTest, dict[tuple[int, str], ValuesRead]] = field(default_factory=dict)
    mutants: dict[PlaceInTest, dict[str, dict[tuple[int, str], ValuesRead]]] = field(default_factory=dict)
    readings: dict[PlaceInTest, list[ReadExpression]] = field(default_factory=dict)
    objects: list[tuple[str, float]] = field(default_factory=list)
    reusable_checks: dict[PlaceInTest, list[ReusableCheck]] = field(default_factory=dict)
    watched: dict[PlaceInTest, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    lost: dict[str, str] = field(default_factory=dict)
    needs_all: bool = False


def merged(first: Measured, second: Measured) -> Measured:
    """Return what was measured in two different sets of places."""
    return Measured(
        originals={**first.originals, **second.originals},
        mutants={**first.mutants, **second.mutants},
        readings={**first.readings, **second.readings},
        objects=first.objects,
        reusable_checks={**first.reusable_checks, **second.reusable_checks},
        watched={**first.watched, **second.watched},
        lost={**first.lost, **second.lost},
        needs_all=first.needs_all or second.needs_all,
    )


def is_reading(text: str) -> bool:
    """Return whether a recorded key is a reading at a test's end: no compared value, no tick recording."""
    return not text.startswith(_NO_READINGS)


def measure(
    request: Request,
    project: SuiteFiles,
    suite: SuiteChecks,
    places: Sequence[PlaceInTest],
    survivors: Survivors,
    progress: Progress,
) -> Measured:
    """Run a copy of the project whose tests record what they can read.

    Args:
        request: for all rounds, fresh ones included.
        places: the tests.
        survivors: those that are run.

    Raises what a baseline raises.
    """
    measured = Measured(objects=object_readings(project))
    additions = []
    for place in places:
        measured.readings[place] = readings_at(project, place)
        checks = suite.reusable_checks(place)
        measured.reusable_checks[place] = checks
        additions.append(_recording_lines(place, measured.readings[place], measured.objects, checks))
        additions += _monitoring_additions(project, suite, place, measured.watched.setdefault(place, {}))
    files = {check.file for check in suite.checks}
    recording = {file: suite.with_recording(file, project.text(file)) for file in files}
    with (
        copy_of(request, edited(project, additions, recording)) as copied,
        CampaignRun.open(copied.changed(probes={_PROBE: 1e9}), progress) as campaign,
    ):
        for result in campaign.originals:
            round, _ = result.task.key
            for place, test, read in _read_in(result, places):
                measured.originals.setdefault(place, {})[round, test] = read
        _run_survivors(campaign, measured, places, survivors)
    return measured


def _run_survivors(
    campaign: CampaignRun,
    measured: Measured,
    places: Sequence[PlaceInTest],
    survivors: Survivors,
) -> None:
    baseline, progress = campaign.baseline, campaign.progress
    now = []
    for survivor, rounds in survivors.values():
        try:
            now.append((campaign.current(survivor.mutant), rounds))
        except MutabotError as error:
            measured.lost[survivor.mutant.id] = str(error)
    reached = {
        mutant.id for mutant, rounds in now if any(baseline.tests_reaching(round, mutant) for round in rounds)
    }
    unreached = {mutant.id for mutant, _ in now} - reached
    measured.lost.update(dict.fromkeys(unreached, "its tests no longer reach it"))
    campaign.prove(mutant for mutant, _ in now if mutant.id in reached)
    trials = [(mutant, round) for mutant, rounds in now for round in rounds]
    progress.stage("survivors", len(trials))
    tasks = (
        campaign.task(mutant, round, baseline.suite(round))
        for mutant, round in trials
        if baseline.tests_reaching(round, mutant)
    )
    for result in campaign.executor.run(tasks):
        mutant, round = result.task.key
        progress.advance(f"#{mutant.number} round {round + 1}")
        reaching = baseline.tests_reaching(round, mutant)  # a check stands where the mutant is reached
        for place, test, read in _read_in(result, places):
            if test in reaching:
                measured.mutants.setdefault(place, {}).setdefault(mutant.id, {})[round, test] = read


def _read_in(result: Result, places: Sequence[PlaceInTest]) -> Iterator[tuple[PlaceInTest, str, ValuesRead]]:
    """Yield what passed tests read, each with its place and node id."""
    prefix, by_node = f"{_PROBE}.", {test.node: test for test in places}
    for end in result.ends:
        values = end.probes.items()
        read = {name.removeprefix(prefix): value for name, value in values if name.startswith(prefix)}
        place = by_node.get(end.test.partition("[")[0])
        if place is not None and read and end.outcome == "passed":
            yield place, end.test, read


def _recording_lines(
    place: PlaceInTest,
    readings: Sequence[ReadExpression],
    objects: Sequence[tuple[str, float]],
    reusable_checks: Sequence[ReusableCheck],
) -> Addition:
    """Return the lines that record readings; they are plain statements, and never fail."""
    # what the oracle does when it reads must not be seen by what only looks
    ordered = sorted(readings, key=lambda reading: reading.way == ORACLE)
    pairs = ", ".join(f"({reading.text!r}, lambda: {reading.text})" for reading in ordered)
    classes = [target for target, _ in objects]
    checks = ", ".join(f"({check.key!r}, lambda: {_holds_expression(check)})" for check in reusable_checks)
    lines = (
        f"from {_RECORDER} import note as _mutabot_note, tolerance_of as _mutabot_tolerance_of",
        f"_mutabot_note(locals(), [{pairs}], {classes!r}, [{checks}])",
    )
    every = [*(reading.needs for reading in readings), *(check.needs for check in reusable_checks)]
    needs = dict.fromkeys(line for needed in every for line in needed)
    return Addition(place, lines, tuple(place.names), tuple(needs))


def _holds_expression(check: ReusableCheck) -> str:
    """Return the expression for whether a check of another test holds."""
    statement = check.statement
    if check.near is not None and check.lacks_tolerance:
        statement = rename(statement, check.near.tolerance, f"_mutabot_tolerance_of({check.near.key!r})")
    return statement.removeprefix("assert ")


def _monitoring_additions(
    project: SuiteFiles, suite: SuiteChecks, place: PlaceInTest, watched: dict[str, tuple[str, ...]]
) -> Iterator[Addition]:
    """Yield the additions that record a test's way, after each name that may be a watchable object."""
    names: Iterable[str] = project.classes_of(place.file)
    if place.style != OTHER:
        function = function_of(project.module(place.file), place)
        names = bound_names(function) if function is not None else ()
    for name in names:
        readings = suite.watched(place, name)
        watched.update(readings)
        pairs = ", ".join(f"({text!r}, lambda: {text})" for text, _ in readings)
        lines = (
            f"from {_TICK_RECORDER} import watch as _mutabot_watch",
            f"_mutabot_watch({name!r}, {name}, [{pairs}])",
        )
        needs = dict.fromkeys(line for _, found in readings for line in found)
        yield Addition(place, lines, (name,), tuple(needs), after=name)


def reading_of(measured: Measured, place: PlaceInTest, text: str) -> ReadExpression:
    """Return the reading of a part; a discrete one may be a step off values that it never had."""
    of = [
        reading
        for reading in measured.readings[place]
        if text == reading.text or text.startswith((f"{reading.text}.", f"{reading.text}["))
    ]
    if of:
        found = replace(max(of, key=lambda reading: len(reading.text)), text=text)
    else:
        objects = [size for target, size in measured.objects if f".{target.rpartition('.')[2]}" in text]
        coarse = max((reading.tolerance for reading in measured.readings[place]), default=1e-6)
        found = ReadExpression(text, *((PROBE, objects[0]) if objects else (HAND, coarse)))
    runs = measured.originals.get(place, {}).values()
    values = {read[text] for read in runs if is_number(read.get(text))}
    step = _step_of(values) if len(values) > 1 else None
    return found if step is None else replace(found, tolerance=max(found.tolerance, _STEPS * step))


#: decimals of a step at most: finer ones look like no steps at all
_DECIMALS = 4


def _step_of(values: Iterable[float]) -> float | None:
    """Return the power of ten below 1 of which all values are multiples; None if none, or all are whole."""
    values = list(values)
    for decimals in range(_DECIMALS + 1):
        if all(abs(value - round(value, decimals)) <= 1e-9 * max(1.0, abs(value)) for value in values):
            return 10.0**-decimals if decimals else None
    return None
