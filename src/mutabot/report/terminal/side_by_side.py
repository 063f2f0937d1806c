"""Families side by side on the terminal: a column each; rows for cost, ends, scores and what they tell."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from mutabot.analysis.ends import End
from mutabot.analysis.families import Family, FamilyComparison, Share
from mutabot.analysis.score import RoundScores
from mutabot.analysis.statistics import Interval
from mutabot.analysis.subsumption import Redundancy

from .console import between, heading, make_table, percent, plural

#: columns of the terminal that the names of rows and each family take
_NAMES, _COLUMN = 24, 14
_WORDS = (
    "Ends: outcomes, one per mutant and round. Trivial: every test that reaches the mutant notices it, in "
    "every round. Informative: valid, not trivial, not indistinguishable. Redundant: dies in the same tests, "
    "rounds and messages as another. Dominators: the fewest mutants whose killing kills all "
    "(docs/compare.md)."
)
_UNKNOWN = (
    "–: not known for mutants that were not run against every test that reaches them; ≥: for some of them."
)
Entry = Callable[[Family], Text]


def print_comparison(console: Console, comparison: FamilyComparison) -> None:
    """Print all of it, in several tables where one would be too wide."""
    for part in _parts(comparison, console.width):
        console.print(part)


def _parts(comparison: FamilyComparison, width: int) -> Iterator[RenderableType]:
    yield Text(_title(comparison), style="bold")
    yield Text(_circumstances(comparison), style="dim")
    at_once = max(1, (width - _NAMES) // _COLUMN)
    for start in range(0, len(comparison.families), at_once):
        families = comparison.families[start : start + at_once]
        for name, rows in _sections(comparison, families):
            yield heading(name)
            yield _table(families, rows)
    yield Text(_WORDS, style="dim")
    if any(one.trivial.unknown or one.redundancy.unknown for one in comparison.families):
        yield Text(_UNKNOWN, style="dim")


def _title(comparison: FamilyComparison) -> str:
    mutants = sum(family.mutants for family in comparison.families)
    done = sum(family.done for family in comparison.families)
    planned = sum(family.planned for family in comparison.families)
    size = f"{plural(mutants, 'mutant')} × {plural(comparison.rounds, 'round')}"
    known = "" if done == planned else f", {done} of {planned} outcomes are known"
    return f"Families side by side, {size}: {comparison.state}{known}"


def _circumstances(comparison: FamilyComparison) -> str:
    meta = comparison.meta
    parts = [f"{key} {meta[key]}" for key in ("mutabot", "engine", "seed") if meta.get(key) is not None]
    seconds = meta.get("seconds")
    if isinstance(seconds, int | float):
        parts.append(f"took {duration(seconds)}")
    drawing = comparison.drawing
    if drawing is not None:
        how = [f"a sample of {drawing.sample}"] if drawing.sample is not None else []
        how += ["one per site"] if drawing.one_per_site else []
        parts.append(f"{' of '.join(how)} of {plural(drawing.selected, 'mutant')}")
    return " · ".join(parts)


def _sections(
    comparison: FamilyComparison, families: Sequence[Family]
) -> Iterator[tuple[str, list[tuple[str, Entry]]]]:
    yield "Size and cost, over all rounds", _size_rows(families)
    occurring = [end for end in End if any(one.ends[end].count for one in comparison.families)]
    yield "What became of them", [(end.value, _end_cell(end)) for end in occurring]
    yield "Scores", _score_rows(families)
    yield "What they can tell, by mutants", _worth_rows(comparison.redundancy)


def _table(families: Sequence[Family], rows: Sequence[tuple[str, Entry]]) -> Table:
    table = make_table()
    table.add_column("", width=_NAMES - 2, overflow="fold")
    for family in families:
        header = f"{family.name}\n{family.role}"
        table.add_column(header, justify="right", width=_COLUMN - 3, overflow="fold")
    for name, cell in rows:
        table.add_row(name, *(cell(family) for family in families))
    return table


def _size_rows(families: Sequence[Family]) -> list[tuple[str, Entry]]:
    rows: list[tuple[str, Entry]] = [("mutants", lambda one: Text(str(one.mutants)))]
    if any(one.population is not None for one in families):
        rows.append(("drawn from", lambda one: Text(_number(one.population))))
    rows += [
        ("places", lambda one: Text(str(one.places))),
        ("wall clock", lambda one: Text(duration(one.cost.wall))),
        ("processor time", lambda one: Text(duration(one.cost.cpu))),
        ("simulated time", lambda one: Text(duration(one.cost.simulated))),
    ]
    if any(one.cost.shared for one in families):
        rows.append(("inherited of it", lambda one: Text(duration(one.cost.shared))))
    return rows


def _end_cell(end: End) -> Entry:
    return lambda family: share_cell(family.ends[end])


def _score_rows(families: Sequence[Family]) -> list[tuple[str, Entry]]:
    rows: list[tuple[str, Entry]] = [
        ("score", lambda one: _score_cell(one.scores)),
        ("check score", lambda one: _check_cell(one.scores)),
    ]
    if any(one.without_oracle is not None for one in families):
        rows.append(("without an oracle", lambda one: _score_cell(one.without_oracle)))
    if any(one.population is not None for one in families):
        rows.append(("score of all, in these rounds", lambda one: Text(between(one.scores.sample_interval))))
    return rows


def _worth_rows(all_families: Redundancy) -> list[tuple[str, Entry]]:
    rows: list[tuple[str, Entry]] = [
        ("valid", lambda one: share_cell(one.valid)),
        ("reached by a test", lambda one: share_cell(one.reached)),
        ("trivial", lambda one: share_cell(one.trivial)),
        ("indistinguishable", lambda one: share_cell(one.indistinguishable)),
        ("informative", lambda one: share_cell(one.informative)),
        ("killed and redundant", lambda one: _of_killed(one, one.redundancy.redundant)),
        ("killed and dominators", lambda one: _of_killed(one, len(one.redundancy.dominators))),
    ]
    classes = len(all_families.dominators)
    if classes and not all_families.unknown:
        rows += [
            (f"of {classes} joint dominators", lambda one: Text(str(one.joint))),
            ("in no other family", lambda one: Text(str(one.alone))),
        ]
    return rows


def share_cell(share: Share) -> Text:
    """``42   35 %`` and the interval below it; at least so many where some are not known."""
    if not share.of or share.unknown == share.of:
        return Text("–")
    if share.unknown:
        return Text(f"≥ {share.count}" if share.count else "–")
    if not share.count:
        return Text("0")
    return _with_interval(f"{share.count:>5} {_short_percent(share.count / share.of):>5}", share.interval)


def _short_percent(share: float) -> str:
    """Two digits: ``8.9 %``, ``35 %``."""
    return f"{100 * share:.1f} %" if share < 0.0995 else f"{100 * share:.0f} %"


def _score_cell(scores: RoundScores | None) -> Text:
    if scores is None:
        return Text("–")
    text = f"{percent(scores.mean)}\n{scores.total.killed}/{scores.total.valid}"
    return _with_interval(text, scores.interval)


def _check_cell(scores: RoundScores) -> Text:
    text = f"{percent(scores.mean_check)}\n{scores.total.by_check}/{scores.total.valid}"
    return _with_interval(text, scores.check_interval)


def _with_interval(text: str, interval: Interval | None) -> Text:
    cell = Text(text)
    return cell if interval is None else cell.append(f"\n{between(interval)}", style="dim")


def _of_killed(family: Family, count: int) -> Text:
    """A number that is known only if every test of the killed mutants was run."""
    redundancy = family.redundancy
    known = redundancy.killed and not redundancy.unknown
    return Text(f"{count} of {redundancy.killed}" if known else "–")


def _number(number: int | None) -> str:
    return "–" if number is None else str(number)


def duration(seconds: float | None) -> str:
    """A time as people say it: ``4.2 s``, ``12.5 min``, ``3.1 h``."""
    if seconds is None:
        return "–"
    if seconds < 100:
        return f"{seconds:.1f} s"
    return f"{seconds / 60:.1f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"
