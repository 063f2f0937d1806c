"""Find the parts of the program that no test reaches: files, functions, and calls of operations.

Files and functions are those that no process has executed, as far as all processes report. A call of an
operation's name was reached if it is a site, or if something else was seen to stand there.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from importlib.util import decode_source
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.campaign.baseline.named_calls import KnownCalls, NamedCall, calls_in
from mutabot.frozen import frozen
from mutabot.journal.records import Untested, UntestedCall
from mutabot.languages.python import FRONT_END as PYTHON
from mutabot.languages.python import extent_of
from mutabot.languages.registry import front_end_of, program_files
from mutabot.model import Operation, Role, Span
from mutabot.model.mutant import Place
from mutabot.model.source_units import ALL_FILES, WHOLE, Executed, functions_of, together

if TYPE_CHECKING:
    from mutabot.campaign.baseline.baseline import Baseline
    from mutabot.execution.task import Result
    from mutabot.model import Vocabulary

#: where something in a file ends, and where the last of all that end there begins
_Ends = Mapping[tuple[str, int, int], tuple[int, int]]
#: what identifies a process that cannot be seen
UNSEEN = "processes"
_DOUBT = "a process that cannot be seen may reach it"
_OTHER_TEXT = "the code that runs is not compiled from this file's text"


@frozen
class _OriginalCode:
    """The code that the runs of the original have shown: executed units, imported files and sites.

    Attributes:
        sites: where calls of operations were made, or of their callables for no command of theirs.
        alone: where something else stood that has an operation's name.
        asked: files in which all calls of such names are asked about.
        imported: files that were imported, as far as that is known.
        executed: units that were executed; None if that is not known.
    """

    sites: _Ends
    alone: _Ends
    asked: frozenset[str]
    imported: frozenset[str]
    executed: Executed | None

    @classmethod
    def of(cls, results: Iterable[Result]) -> _OriginalCode:
        results = list(results)
        sites = [site.span for result in results for site in result.sites]
        asked = [event for result in results for event in result.asked]
        sites += [span for event in asked for span in event.unmeant]
        executed = together(end.executed for result in results for end in result.ends)
        imported = {file for result in results if result.seen for file in result.seen.imported}
        files = {file for event in asked for file in event.files}
        return cls(
            _ends(sites),
            _ends(span for event in asked for span in event.alone),
            frozenset(files),
            frozenset({*imported, *files, *(executed or ()), *(span.file for span in sites)}),
            executed,
        )

    @property
    def knows_files(self) -> bool:
        """Whether a file without any executed unit was not imported."""
        return self.executed is not None and ALL_FILES not in self.executed

    def is_executed(self, file: str, line: int) -> bool:
        lines = (self.executed or {}).get(file, ())
        return line in lines or WHOLE in lines


def _ends(spans: Iterable[Span]) -> _Ends:
    ends: dict[tuple[str, int, int], tuple[int, int]] = {}
    for span in spans:
        end, start = (span.file, span.end_line, span.end_column), (span.line, span.column)
        ends[end] = max(start, ends.get(end, start))
    return ends


def _is_among(span: Span, ends: _Ends) -> bool:
    """Return whether a call was seen: a chain over several lines begins later for the interpreter.

    What begins earlier is something around the call, such as a ``with`` statement.
    """
    return (span.line, span.column) <= ends.get((span.file, span.end_line, span.end_column), (0, 0))


def add_untested(
    baseline: Baseline, root: Path, program: Sequence[str], vocabulary: Vocabulary, results: Iterable[Result]
) -> None:
    """Note in a baseline what its tests do not reach."""
    seen = _OriginalCode.of(results)
    texts = dict(_texts(root, program_files(root, program)))
    files = [file for file in texts if file not in seen.imported] if seen.knows_files else []
    functions, idle = _functions(texts, seen) if seen.knows_files else (0, [])
    calls, total = _calls(baseline, vocabulary, texts, seen)
    is_unseen = any(remark.source == UNSEEN for remark in baseline.remarks)
    doubts = [call.doubt or (_DOUBT if is_unseen else "") for call in calls]
    unreached = [
        Place(call.site, call.operation, call.pattern)
        for call, doubt in zip(calls, doubts, strict=True)
        if not doubt
    ]
    # mutants where only excluded tests reach a call are not judged, and must not vanish
    aside = dict.fromkeys(place for _, place in baseline.flaky_reaching if _is_lost(baseline, place))
    baseline.unreached = (*unreached, *aside)
    untested = [
        UntestedCall(call.site.place, call.site.text, call.operation, doubt)
        for call, doubt in zip(calls, doubts, strict=True)
    ]
    baseline.untested = Untested(
        calls=total + len({place.site for place in baseline.unreached}),
        functions=functions,
        files=len(texts),
        unreached_calls=tuple(call for call in untested if not call.doubt),
        unreached_functions=tuple(idle),
        unreached_files=tuple(files),
        doubtful_calls=tuple(call for call in untested if call.doubt),
    )


def _is_lost(baseline: Baseline, place: Place) -> bool:
    """Return whether no test that judges reaches a call of the program."""
    return place.site.role is Role.PROGRAM and place not in baseline.hits


def _texts(root: Path, files: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the name and text of each file of the program that holds more than a docstring.

    A file that cannot be parsed has an empty one: it cannot be imported.
    """
    for file in files:
        if front_end_of(file) is not PYTHON:
            continue
        try:
            text = decode_source((root / file).read_bytes())
            body = ast.parse(text).body
        except OSError:
            continue
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            yield file, ""
            continue
        if any(
            not isinstance(statement, ast.Expr) or not isinstance(statement.value, ast.Constant)
            for statement in body
        ):
            yield file, text


def _does_nothing(statement: ast.stmt) -> bool:
    is_constant = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
    return is_constant or isinstance(statement, ast.Pass)


def _functions(texts: Mapping[str, str], seen: _OriginalCode) -> tuple[int, list[str]]:
    """Return the number of functions, and the names of those that no test calls."""
    found = [
        (file, name, node)
        for file, text in texts.items()
        for name, node in functions_of(ast.parse(text))
        if not all(map(_does_nothing, node.body))  # overloads, protocols, what subclasses must define
    ]
    idle = [
        f"{file}:{node.lineno} {name}"
        for file, name, node in found
        if not seen.is_executed(file, node.lineno)
    ]
    return len(found), idle


def _calls(
    baseline: Baseline, vocabulary: Vocabulary, texts: Mapping[str, str], seen: _OriginalCode
) -> tuple[list[NamedCall], int]:
    """Return the calls that no test reaches, and the number of sites that tests reach."""
    operations = [
        operation
        for operation in vocabulary.operations
        if operation.named is None and operation.kind in (None, "methods")
    ]
    targets = {operation.target for operation in operations}
    places = [
        place for place in baseline.hits if place.operation in targets and place.site.role is Role.PROGRAM
    ]
    known = _known(operations, places, texts, seen)
    spans = {place.site.span for place in places}
    found = []
    for file, text in texts.items() if operations else ():
        if file in seen.imported and file not in seen.asked:
            continue  # whether its calls were made is not known
        unreached = [
            call
            for call in calls_in(text, file, known)
            if not _is_among(call.site.span, seen.sites) and not _is_among(call.site.span, seen.alone)
        ]
        if unreached and not _are_of(text, [span for span in spans if span.file == file]):
            unreached = [replace(call, doubt=call.doubt or _OTHER_TEXT) for call in unreached]
        found += unreached
    return found, len({place.site for place in places})


def _are_of(text: str, spans: Iterable[Span]) -> bool:
    """Return whether a text has code at all of these spans, as a loader may have compiled another text."""
    nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.expr | ast.stmt)]
    places = {extent_of(node) for node in nodes}
    ends = {extent_of(node)[2:] for node in nodes if isinstance(node, ast.Call)}
    found = ((span.line, span.column, span.end_line, span.end_column) for span in spans)
    return all(place in places or place[2:] in ends for place in found)


def _known(
    operations: Iterable[Operation], places: Iterable[Place], texts: Mapping[str, str], seen: _OriginalCode
) -> KnownCalls:
    by_name: dict[str, list[Operation]] = {}
    for operation in operations:
        by_name.setdefault(operation.last_name, []).append(operation)
    own = {part.removesuffix(".py") for file in texts for part in file.split("/")}
    reached: dict[str, set[str]] = {}
    for place in places:
        reached.setdefault(place.site.text, set()).add(place.operation)
    alone: set[str] = set()
    for file in {file for file, _, _ in seen.alone} & texts.keys():
        everything = calls_in(texts[file], file, KnownCalls(by_name, own, {}, ()))
        alone |= {call.site.text for call in everything if _is_among(call.site.span, seen.alone)}
    return KnownCalls(by_name, own, reached, alone)
