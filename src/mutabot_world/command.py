"""``mutabot world``: shows how the disturbances of the last campaign ended."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Annotated, Any

import typer

from mutabot.api.reports import CommandContext, Results, UsageError

from .files import NO_PARAMETER
from .ladders import Tolerances, WorldLadder, combined_ladders, ladders
from .units import with_unit

_AMOUNT = re.compile(r"(\d+(?:\.\d+)?) ?(m|mm|deg|rad)")
#: what a recording measures in
_OWN = {"mm": ("m", 0.001), "rad": ("deg", 57.29577951308232)}
_LEGEND = "· lived with   ! suffered unseen   ▒ some rounds notice   █ all notice   ? passed, needs a probe"

_Tolerance = Annotated[
    list[str] | None,
    typer.Option("--tolerance", metavar="SIZE", help="How far things may end apart, such as '5 mm'."),
]
_PageFile = Annotated[
    Path | None, typer.Option("--html", metavar="FILE", help="Write the tables as a page, with recordings.")
]


def world(
    context: CommandContext, tolerance: _Tolerance = None, html: _PageFile = None, json: bool = False
) -> None:
    """Show how large a disturbance of the world the tests notice, and which ones they miss.

    Disturbances that are suffered unseen come first: all tests pass, and the world ends otherwise.
    """
    limits = _tolerances(tolerance or ())
    results = context.results()
    found = ladders(results, limits)
    if not found:
        raise UsageError(f"no world was disturbed: `mutabot run --family world` does; {NO_PARAMETER}")
    if html is not None:
        _write(context, results, found, html)
    if json:
        data = {"parameters": _data(combined_ladders(found)), "tests": _data(found)}
        context.print_json({"state": results.state, "rounds": results.rounds, **data})
    else:
        for title, lines in sections(found):
            if lines:
                context.print_section(title, lines)


def _tolerances(texts: Sequence[str]) -> Tolerances:
    """Read tolerances. Raises UsageError."""
    found: dict[str, float] = {}
    for text in texts:
        read = _AMOUNT.fullmatch(text.strip())
        if read is None:
            raise UsageError(f"--tolerance {text!r}: a number with one of the units m, mm, deg, rad")
        unit, factor = _OWN.get(read[2], (read[2], 1.0))
        found[unit] = float(read[1]) * factor
    return found


def sections(found: Sequence[WorldLadder]) -> Iterator[tuple[str, list[str]]]:
    """Yield both tables and the disturbances suffered unseen, as titles with lines for a terminal."""
    whole = combined_ladders(found)
    known = [ladder for ladder in whole if ladder.ends]
    columns = ("parameter", "tried", "magnitudes", "unseen at", "noticed from", "by")
    rows = [
        (
            *_name(ladder),
            ladder.bar,
            ladder.span(ladder.unseen) if ladder.unseen else "–",
            _noticed(ladder),
            _noticed_by(ladder),
        )
        for ladder in whole
    ]
    yield "What the tests notice, suffered unseen first", [*_table(columns, rows), "", _LEGEND]
    yield "In sentences", [f"{ladder.sentence[0].upper()}{ladder.sentence[1:]}." for ladder in known]
    unseen = [f"{ladder.parameter} {ladder.direction}: {ladder.finding}" for ladder in whole if ladder.unseen]
    yield "Suffered unseen: all tests pass, and the world ends otherwise", unseen
    robust = [(*_name(ladder), ladder.robust) for ladder in known]
    title = "How robust the program is: up to which size the task is done"
    yield title, _table(("parameter", "tried", "lived with up to"), robust)
    if len({ladder.tests for ladder in found}) > 1:
        first = sorted(
            (ladder for ladder in found if ladder.ends),
            key=lambda ladder: (not ladder.unseen, ladder.parameter),
        )
        by_test = [(ladder.parameter + ladder.direction, ladder.bar, ladder.tests[0]) for ladder in first]
        yield "By test", _table(("parameter", "magnitudes", "test"), by_test)
    unknown = [
        f"{ladder.parameter} {ladder.direction}: {ladder.why_unknown}" for ladder in whole if not ladder.ends
    ]
    yield "Nothing is known of", unknown


def _name(ladder: WorldLadder) -> tuple[str, str]:
    sign = {"+": " +", "-": " −"}.get(ladder.direction, "")
    sizes = sorted(ladder.found)
    return f"{ladder.parameter}{sign}", f"{sizes[0]:g} … {with_unit(sizes[-1], ladder.unit)}"


def _noticed(ladder: WorldLadder) -> str:
    if not ladder.ends:
        return "not known"
    return "never" if ladder.noticed_from is None else with_unit(ladder.noticed_from, ladder.unit)


def _noticed_by(ladder: WorldLadder) -> str:
    """Return what notices the threshold: a check of the tests, or an error that stops the program."""
    if ladder.noticed_from is None:
        return ""
    rounds = ladder.found[ladder.noticed_from].values()
    stops = [each.is_stop for tests in rounds for each in tests.values() if each.end.value == "noticed"]
    return "check" if not any(stops) else "exception" if all(stops) else "check, exception"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(len(row[n]) for row in (head, *rows)) for n in range(len(head))]
    padded = ([cell.ljust(width) for cell, width in zip(row, widths, strict=True)] for row in (head, *rows))
    return ["  ".join(cells).rstrip() for cells in padded]


def _data(found: Sequence[WorldLadder]) -> list[dict[str, Any]]:
    """Return the ladders as plain data for JSON."""
    return [
        {
            **{key: getattr(ladder, key) for key in ("parameter", "direction", "unit")},
            "tests": list(ladder.tests),
            "magnitudes": sorted(ladder.found),
            "ends": {f"{size:g}": str(ladder.end(size)) for size in sorted(ladder.found)},
            "lived_with_up_to": ladder.robust_to,
            **{key: getattr(ladder, key) for key in ("noticed_from", "unseen", "sentence", "finding")},
        }
        for ladder in found
    ]


def _write(context: CommandContext, results: Results, found: Sequence[WorldLadder], path: Path) -> None:
    from .page import page  # noqa: PLC0415  # few ask for it

    with closing(context.recordings()) as recordings:
        text = page(results, found, recordings)
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UsageError(f"--html {path}: {error.strerror or error}") from None
