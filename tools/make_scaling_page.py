"""Write docs/scaling.md and docs/img/scaling.svg from benchmarks/scaling.json.

    python tools/make_scaling_page.py            write them
    python tools/make_scaling_page.py --check    exit with 1 if one is out of date

``benchmarks/cluster_simulation.py`` measures the costs and simulates.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parents[1] / "docs"
DATA, PAGE, PICTURE = (
    DOCS.parent / "benchmarks" / "scaling.json",
    DOCS / "scaling.md",
    DOCS / "img" / "scaling.svg",
)
WIDTH, HEIGHT = 860, 400
INK, FAINT, GRID, PAPER = "#222222", "#6b6b6b", "#e6e8eb", "#ffffff"
ENGINES = {"replay": "#2f6fb0", "fork": "#1b7837"}
#: what time is lost to, in the order of the bars, with its colour
LOST = {
    "originals": ("the original's own runs", "#8d8d8d"),
    "shipped": ("shipping", "#d9c84a"),
    "waited": ("the controller", "#c51b29"),
    "begun": ("beginning", "#9ecae1"),
    "lost": ("dead workers", "#000000"),
    "stragglers": ("stragglers", "#f4a582"),
    "last": ("the last unit", "#c994c7"),
}
BARS = (10, 100, 300, 1000)


TEXT = """\
# What do many machines gain?

<!-- Written by tools/make_scaling_page.py from benchmarks/scaling.json. Do not edit. -->

A campaign of {mutants} mutants × {rounds} rounds on 1 to 1,000 workers, simulated event by event with
measured costs (nobody has run one yet). The speed-up is against one worker without chance, which never dies
and whose runs take their mean time: with fork it takes {alone} h. Efficiency is the speed-up per worker: at
100 workers {replay} with replay, {fork} with fork.

![Speed-up curves, and bars of what time is lost to](img/scaling.svg)

Time is lost to *the original's own runs* (each part of a fork parent runs its tests again), *shipping*, *the
controller* (a worker whose answer waits is idle), *beginning* (a worker starts and gets the project), *dead
workers* (what they had done of a unit), *stragglers* (idle time at the end that equal units and no deaths
would avoid) and *the last unit*.

{curve}

The controller is the limit: one process that takes {replay_ms} ms or {fork_ms} ms per outcome. Mutants that
take longer than here (a few seconds with replay, a quarter of a second with fork) keep as many more workers
busy. With one worker, each death in an uncut fork parent loses half a round: hence 0.63.

## How large should a unit be?

Replay: a mutant in a round. A fork parent is cut; with 100 workers, shares of time in %:

{sizes}

The executor cuts 16 parts per worker, at least ten mutants each, mutants of the same tests together,
longest first.

## The baseline

Not in these numbers: it runs first on the controller's machine. Two runs in each of ten rounds take
{baselines} processes side by side.

## What was measured, and what is assumed

- Program: {copies} copies of [examples/pick_and_place](../examples/pick_and_place/README.md), each with its
  own tests: {own} mutants of family `robot`, a suite of {suite} s.
- {sessions} sessions of replay took {session_range} s, {forks} forks {fork_range} s; equal runs of a test
  {quickest} to {slowest} times their mean on a busy machine.
- Controller, beside the outcomes: 3 ms per unit. Worker: 28 ms per unit, 4 s to start, 0.2 s for the project.
- Assumed: a worker dies once in 24 hours, is missed after 5 s; all are equally fast.

`python benchmarks/cluster_simulation.py` simulates and stores `benchmarks/scaling.json`, which says how the
costs were measured.
"""


def curves(found: Mapping[str, Any]) -> Iterator[str]:
    """The speed-up of both engines, both axes logarithmic."""
    left, top, side = 62.0, 60.0, 290.0

    def at(workers: float, speed: float) -> tuple[float, float]:
        return left + side * math.log10(workers) / 3, top + side * (1 - math.log10(max(speed, 1)) / 3)

    yield text(left, 34, "Speed-up by the number of workers", 15, bold=True)
    for power in range(4):
        x, y = at(10**power, 10**power)
        yield line([(x, top), (x, top + side)], GRID)
        yield line([(left, y), (left + side, y)], GRID)
        yield text(x, top + side + 18, f"{10**power:,}", 12, "middle", FAINT)
        yield text(left - 8, y + 4, f"{10**power:,}", 12, "end", FAINT)
    yield line([at(1, 1), at(1000, 1000)], FAINT, dashes="4 4")
    for engine, colour in ENGINES.items():
        points = [at(row["workers"], row["speed_up"]) for row in found[engine]]
        yield line(points, colour, width=2.2)
        for x, y in points:
            yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.4" fill="{colour}"/>'
    for number, (engine, colour) in enumerate(ENGINES.items()):
        yield line(
            [(left + 14, top + 16 + 20 * number), (left + 40, top + 16 + 20 * number)], colour, width=2.2
        )
        yield text(left + 46, top + 20 + 20 * number, engine, 12)
    yield text(left + 14, top + 62, "dashed: none lost", 12, colour=FAINT)


def bars(found: Mapping[str, Any]) -> Iterator[str]:
    """What the time of all workers is lost to."""
    left, top, width = 470.0, 60.0, 320.0
    yield text(left - 70, 34, "Time of all workers that is lost, and to what", 15, bold=True)
    rows = [(engine, row) for engine in ENGINES for row in found[engine] if row["workers"] in BARS]
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        x = left + width * share
        yield line([(x, top), (x, top + 238)], GRID)
        yield text(x, top + 254, f"{share:.0%}", 12, "middle", FAINT)
    y = top + 4
    for number, (engine, row) in enumerate(rows):
        if number and engine != rows[number - 1][0]:
            y += 14
        yield text(left - 8, y + 15, f"{engine} {row['workers']:,}", 12, "end")
        x = left
        for name, (_, colour) in LOST.items():
            part = width * row["shares"][name]
            yield f'<rect x="{x:.1f}" y="{y:.1f}" width="{part:.1f}" height="20" fill="{colour}"/>'
            x += part
        y += 27
    for number, (words, colour) in enumerate(LOST.values()):
        x, y = left - 70 + (0, 175, 300)[number % 3], top + 276 + 20 * (number // 3)
        yield f'<rect x="{x:.1f}" y="{y - 10:.1f}" width="12" height="12" fill="{colour}"/>'
        yield text(x + 18, y, words, 12)


def text(
    x: float, y: float, words: str, size: int, anchor: str = "start", colour: str = INK, *, bold: bool = False
) -> str:
    """A line of text."""
    weight = ' font-weight="bold"' if bold else ""
    place = f'x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}"'
    return f'<text {place} fill="{colour}"{weight}>{escape(words)}</text>'


def line(points: Sequence[tuple[float, float]], colour: str, *, width: float = 1.0, dashes: str = "") -> str:
    """Straight lines from point to point."""
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
    return f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width}"{dashed}/>'


def picture(found: Mapping[str, Any]) -> str:
    """The picture as SVG."""
    shapes = "\n".join([*curves(found), *bars(found)])
    size = f'width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif">\n'
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="{PAPER}"/>\n{shapes}\n</svg>\n'
    )


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table."""
    lines = [f"| {' | '.join(heads)} |", f"|{'---|' * len(heads)}"]
    return "\n".join([*lines, *(f"| {' | '.join(row)} |" for row in rows)])


def percent(share: float) -> str:
    """``8.4``."""
    return f"{100 * share:.1f}"


def page(data: Mapping[str, Any]) -> str:
    """The text of the page."""
    found, costs = data["found"], data["costs"]
    return TEXT.format(
        mutants=f"{found['mutants']:,}",
        rounds=found["rounds"],
        replay=f"{row_of(found, 'replay', 100)['efficiency']:.2f}",
        fork=f"{row_of(found, 'fork', 100)['efficiency']:.2f}",
        alone=f"{row_of(found, 'fork', 1)['hours'] * row_of(found, 'fork', 1)['speed_up']:.0f}",
        curve=_curve_table(found),
        sizes=_size_table(found),
        baselines=_baselines(found),
        copies=f"{found['mutants'] / costs['mutants']:,.0f}",
        own=costs["mutants"],
        suite=f"{costs['suite']:.1f}",
        sessions=len(costs["replay"]),
        session_range=_range(costs["replay"]),
        forks=len(costs["fork"]),
        fork_range=_range(costs["fork"]),
        quickest=f"{min(costs['spread']):.2f}",
        slowest=f"{max(costs['spread']):.2f}",
        replay_ms=f"{1e3 * costs['controller']['replay']:.1f}",
        fork_ms=f"{1e3 * costs['controller']['fork']:.1f}",
    )


def row_of(found: Mapping[str, Any], engine: str, workers: int) -> Mapping[str, Any]:
    """What came of one number of workers."""
    row: Mapping[str, Any] = next(known_row for known_row in found[engine] if known_row["workers"] == workers)
    return row


def _curve_table(found: Mapping[str, Any]) -> str:
    heads = (
        "engine", "workers", "units", "hours", "speed-up", "efficiency", "controller at work",
    )  # fmt: skip
    rows = [
        (
            engine, f"{row['workers']:,}", f"{row['units']:,}", f"{row['hours']:,.1f}",
            f"{row['speed_up']:,.1f}", f"{row['efficiency']:.2f}",
            f"{row['controller']:.0%}",
        )
        for engine in ENGINES
        for row in found[engine]
    ]  # fmt: skip
    return table(heads, rows)


def _size_table(found: Mapping[str, Any]) -> str:
    rows = [
        (
            row["name"], f"{row['units']:,}", f"{row['efficiency']:.2f}", percent(row["shares"]["originals"]),
            percent(row["shares"]["idle"]),
        )
        for row in found["sizes"]
    ]  # fmt: skip
    heads = (
        "fork parent of a round",
        "units",
        "efficiency",
        "original's runs",
        "idle at the end",
    )
    return table(heads, rows)


def _baselines(found: Mapping[str, Any]) -> str:
    return ", ".join(
        f"{baseline['hours']:,.1f} h with {baseline['places']}" for baseline in found["baseline"]
    )


def _range(numbers: Sequence[float]) -> str:
    ordered = sorted(numbers)
    return f"{ordered[0]:.2f} to {ordered[-1]:.2f} (median {ordered[len(ordered) // 2]:.2f})"


def main(arguments: Sequence[str]) -> int:
    """The command."""
    data = json.loads(DATA.read_text(encoding="utf-8"))
    files = {PAGE: page(data), PICTURE: picture(data["found"])}
    if "--check" in arguments:
        old = [path for path, words in files.items() if path.read_text(encoding="utf-8") != words]
        for path in old:
            print(f"{path} is out of date: run python tools/make_scaling_page.py", file=sys.stderr)
        return 1 if old else 0
    for path, words in files.items():
        path.write_text(words, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
