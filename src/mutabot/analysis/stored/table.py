"""Outcomes as a table: one row per mutant and round that has been run. docs/reports.md has the columns.

Names, types and units are stable: columns may be added, at the end.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from mutabot.analysis.results import MutantResult, Results
from mutabot.errors import UsageError
from mutabot.frozen import frozen
from mutabot.model import Outcome

if TYPE_CHECKING:
    import pandas

#: what a cell may hold; None is a value that is not known or does not apply
Cell = str | int | float | bool | None


@frozen
class Column:
    """A column of the table.

    Attributes:
        name: its stable name; one with a unit ends in it.
        kind: type of its cells.
        meaning: what it says, in a line.
        of: the cell for a mutant's outcome.
    """

    name: str
    kind: type
    meaning: str
    of: Callable[[MutantResult, Outcome], Any]


def rows(results: Results) -> Iterator[tuple[Cell, ...]]:
    """The cells of all outcomes, in the order of ``COLUMNS``: by mutant, then by round."""
    for result in results.everything:
        for outcome in result.outcomes:
            yield tuple(_cell(column, result, outcome) for column in COLUMNS)


def frame_of(results: Results) -> pandas.DataFrame:
    """The table for pandas. Raises UsageError if it is not installed."""
    try:
        import pandas  # noqa: PLC0415  # an extra, and slow
    except ImportError as error:
        raise missing("pandas", "a data frame") from error
    cells = list(zip(*rows(results), strict=True)) or [() for _ in COLUMNS]
    return pandas.DataFrame(
        {
            column.name: pandas.array(list(those), dtype=_DTYPES[column.kind])
            for column, those in zip(COLUMNS, cells, strict=True)
        }
    )


def missing(library: str, wanted: str) -> UsageError:
    """What to say where a library of an extra is not installed."""
    install = "pip install 'path/to/mutabot[notebook]'"
    return UsageError(f"{wanted} needs {library}, which is not installed: {install}")


def _cell(column: Column, result: MutantResult, outcome: Outcome) -> Cell:
    found = column.of(result, outcome)
    if found is None or (isinstance(found, float) and not math.isfinite(found)):
        return None
    made: Cell = column.kind(found)
    return made


#: names of pandas's types that can be missing
_DTYPES = {str: "string", int: "Int64", float: "Float64", bool: "boolean"}


def _unit(result: MutantResult) -> str | None:
    return result.quantity.unit if result.quantity is not None else None


def _example(index: int) -> Callable[[MutantResult, Outcome], Any]:
    def cell(_: MutantResult, outcome: Outcome) -> Any:
        pair = outcome.example
        return pair[index] if pair is not None and len(pair) == 2 else None

    return cell


#: in this order they stand in files
COLUMNS: tuple[Column, ...] = (
    Column("mutant", str, "stable id of the mutant", lambda m, o: m.mutant.id),
    Column("number", int, "its number in this campaign", lambda m, o: m.mutant.number),
    Column("round", int, "the round, from 1", lambda m, o: o.round + 1),
    Column("family", str, "family of its operator", lambda m, o: m.mutant.family),
    Column("role", str, "`program` or `oracle`", lambda m, o: m.mutant.site.role.value),
    Column("operator", str, "its operator", lambda m, o: m.mutant.operator),
    Column("variant", str, "which of several mutants of the operator here", lambda m, o: m.mutant.variant),
    Column("file", str, "file, relative to the project", lambda m, o: m.mutant.site.span.file),
    Column("line", int, "line of the call, from 1", lambda m, o: m.mutant.site.span.line),
    Column("column", int, "column, from 1, in UTF-8 bytes", lambda m, o: m.mutant.site.span.column + 1),
    Column("function", str, "enclosing function", lambda m, o: m.mutant.site.span.function),
    Column("call", str, "the callee or text as written", lambda m, o: m.mutant.site.text),
    Column("operation", str, "the operation of the vocabulary", lambda m, o: m.mutant.operation or None),
    Column("quantity", str, "the quantity that is changed", lambda m, o: m.mutant.quantity),
    Column("unit", str, "unit of `before` and `after`", lambda m, o: _unit(m)),
    Column("description", str, "what the mutant does", lambda m, o: m.mutant.description),
    Column("verdict", str, "see [verdicts](verdicts.md)", lambda m, o: o.verdict.value),
    Column("by", str, "`check` or `exception`, for a kill", lambda m, o: o.by.value if o.by else None),
    Column(
        "valid", bool, "whether it stands in the denominator of the score", lambda m, o: o.verdict.is_valid
    ),
    Column("killed", bool, "whether it stands in the numerator", lambda m, o: o.verdict.is_killed),
    Column("test", str, "the test that ended otherwise", lambda m, o: o.test),
    Column("exception", str, "type of its exception, as `module:Name`", lambda m, o: o.exception),
    Column(
        "message", str, "first lines of its text, or why the verdict is what it is", lambda m, o: o.message
    ),
    Column("place", str, "`file:line` where it was noticed", lambda m, o: o.place),
    Column("hits", int, "calls at the mutant's site", lambda m, o: o.hits),
    Column("acted", int, "hits at which it changed something", lambda m, o: o.acted),
    Column("before", str, "value at the first of these, as text", _example(0)),
    Column("after", str, "the value in its place, as text", _example(1)),
    Column("tests", int, "number of tests run", lambda m, o: o.tests),
    Column("wall_s", float, "seconds from the start of the process to its end", lambda m, o: o.wall),
    Column("cpu_s", float, "processor seconds of the tests", lambda m, o: o.cpu),
    Column("simulated_s", float, "simulated seconds of the tests", lambda m, o: o.simulated),
    Column(
        "distance", float, "greatest difference of a probe at the end, in tolerances", lambda m, o: o.distance
    ),
    Column("way", float, "greatest difference of a probe along the way, in tolerances", lambda m, o: o.way),
    Column("indistinguishable", bool, "whether nothing differed", lambda m, o: o.indistinguishable),
    Column("divergence", str, "what ended otherwise, the worst", lambda m, o: next(iter(o.divergence), None)),
    Column("commands", int, "commands before the deciding test ended", lambda m, o: o.commands),
    Column("engine", str, "engine that ran it", lambda m, o: o.engine),
    Column("repeats", int, "how often it was run once more, and ended the same", lambda m, o: o.repeats),
    Column("magnitude", float, "of a graded mutant: how big its fault is", lambda m, o: m.mutant.magnitude),
    Column("magnitude_unit", str, "unit of `magnitude`", lambda m, o: m.mutant.unit),
    Column(
        "direction", str, "of a graded mutant: `+`, `-` or nothing", lambda m, o: m.mutant.direction or None
    ),
)
