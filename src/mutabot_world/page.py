"""The tables of disturbances as an HTML page, with the recordings of those suffered unseen."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

from mutabot.api.reports import LiveReport, RecordedPaths, Results

from .ladders import WorldEnd, WorldLadder, combined_ladders

#: recordings that are drawn, and edge of a drawing in pixels
_DRAWN, _EDGE = 30, 260
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 75rem; padding: 0 1rem;
       color: #1c1e21; background: #fff }
h1 { font-size: 1.5rem } h2 { font-size: 1.15rem; margin-top: 2.2rem }
table { border-collapse: collapse } th, td { padding: .25rem .7rem; text-align: left; vertical-align: top;
       border-bottom: 1px solid #ddd } .wide { overflow-x: auto }
i { display: inline-block; min-width: 2.2rem; padding: 0 .2rem; text-align: center; font-style: normal;
    border: 1px solid #fff; font-size: .8rem }
.noticed { background: #cfe8d4 } .lived-with { background: #e8eef5 } .suffered-unseen { background: #f6b8a8;
    font-weight: 600 } .passed, .not-known { background: #eee } .some { outline: 2px dashed #888 }
figure { display: inline-block; margin: .6rem 1.2rem .6rem 0 }
figcaption { max-width: 17rem; font-size: .85rem; overflow-wrap: anywhere }
svg { background: #f7f8fa }
"""
_KEY = "Ways of tool and things from above: grey as in the original, red disturbed; dots where they end."
_LEGEND = (
    (WorldEnd.UNSEEN, "all tests pass, and the world ends otherwise"),
    (WorldEnd.LIVED, "all tests pass, and the world ends as it should"),
    (WorldEnd.NOTICED, "a test fails in every round"),
    (WorldEnd.PASSED, "all tests pass, and it is unknown how the world ended"),
    (WorldEnd.UNKNOWN, "it disturbed nothing, or was not judged"),
)


def page(results: Results, found: Sequence[WorldLadder], recordings: Any) -> str:
    """Return the page.

    Args:
        results: of the campaign.
        found: a ladder for each parameter, direction and test.
        recordings: what was recorded in the campaign.
    """
    whole = combined_ladders(found)
    tests = list(dict.fromkeys(test for ladder in found for test in ladder.tests))
    by_test = {(ladder.parameter, ladder.direction, ladder.tests[0]): ladder for ladder in found}
    legend = "".join(f"<p>{_cell('size', end)} {escape(str(end))}: {text}</p>" for end, text in _LEGEND)
    head = "<tr><th>parameter<th>all tests" + "".join(
        f"<th>{_text(test.rpartition('::')[2])}" for test in tests
    )
    rows = "".join(
        f"<tr><th>{_text(_name(ladder))}<td>{_bar(ladder)}"
        + "".join(f"<td>{_bar(by_test.get((ladder.parameter, ladder.direction, test)))}" for test in tests)
        for ladder in whole
    )
    findings = "".join(
        f"<li>{_text(ladder.sentence)}{f'<br><b>{_text(ladder.finding)}</b>' if ladder.finding else ''}"
        for ladder in whole
    )
    robust = "".join(
        f"<tr><td>{_text(_name(ladder))}<td>{_text(ladder.robust)}" for ladder in whole if ladder.ends
    )
    parts = (
        "<h1>Disturbances of the world</h1>"
        f"<p>{_text(results.state)}, {results.rounds} round{'s' * (results.rounds != 1)}</p>{legend}",
        f'<h2>Parameters by tests</h2><div class="wide"><table>{head}{rows}</table></div>',
        f"<h2>What the tests notice</h2><ul>{findings}</ul>",
        "<h2>How robust the program is</h2><p>The size up to which the task is done.</p>"
        f"<table><tr><th>parameter<th>lived with up to{robust}</table>",
        "".join(_figures(results, found, recordings)),
    )
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>Disturbances of the world</title>'
        f"<style>{_STYLE}</style>{''.join(parts)}</html>\n"
    )


def _figures(results: Results, found: Sequence[WorldLadder], recordings: Any) -> Iterable[str]:
    """Yield a drawing of each ladder's largest magnitude that was suffered unseen."""
    ids = {result.mutant.number: result.mutant.id for result in results.graded}
    drawn = [found_ladder for found_ladder in found if found_ladder.unseen][:_DRAWN]
    yield f"<h2>Recordings of what was suffered unseen</h2><p>{_KEY}</p>" if drawn else ""
    for ladder in drawn:
        size, test = ladder.unseen[-1], ladder.tests[0]
        number = ladder.numbers[size, test]
        rounds = (n for n, each in sorted(ladder.found[size].items()) if each[test].end is WorldEnd.UNSEEN)
        original, mutant = recordings.pair(ids[number], next(rounds), test)
        if original is not None and mutant is not None:
            story = ladder.story(size, WorldEnd.UNSEEN)[0]
            text = f"{ladder.texts[size]}, {test.rpartition('::')[2]} (mutant {number}): {story}"
            drawing = _drawing(RecordedPaths(original), RecordedPaths(mutant))
            yield f"<figure>{drawing}<figcaption>{_text(text)}</figcaption></figure>"


def _drawing(original: RecordedPaths, mutant: RecordedPaths) -> str:
    """Draw both recordings from above: the original grey, the disturbed one red, a dot at each path's end."""
    lines = [
        ([(x, y) for x, y, *_ in path.outline], colour)
        for paths, colour in ((original.paths, "#9aa4ae"), (mutant.paths, "#c8371b"))
        for path in paths.values()
        if path.track.kind.width > 1
    ]
    points = [point for line, _ in lines for point in line] or [(0.0, 0.0)]
    left, low = (min(axis) for axis in zip(*points, strict=True))
    right, high = (max(axis) for axis in zip(*points, strict=True))
    scale = (_EDGE - 20) / max(right - left, high - low, 1e-6)
    shapes = []
    for line, colour in lines:
        placed = [(10 + scale * (x - left), _EDGE - 10 - scale * (y - low)) for x, y in line]
        way = " ".join(f"{x:.1f},{y:.1f}" for x, y in placed)
        end = f'<circle cx="{placed[-1][0]:.1f}" cy="{placed[-1][1]:.1f}" r="3" fill="{colour}"/>'
        shapes.append(f'<polyline points="{way}" fill="none" stroke="{colour}"/>{end}')
    label = 'role="img" aria-label="ways from above"'
    return f'<svg width="{_EDGE}" height="{_EDGE}" {label}>{"".join(shapes)}</svg>'


def _bar(ladder: WorldLadder | None) -> str:
    if ladder is None:
        return "–"
    cells = ((size, ladder.end(size), ladder.is_sometimes_noticed(size)) for size in sorted(ladder.found))
    return (
        "".join(_cell(f"{size:g}", end, is_some=some) for size, end, some in cells) + f" {ladder.unit or ''}"
    )


def _cell(text: str, end: WorldEnd, *, is_some: bool = False) -> str:
    kind = str(end).replace(" ", "-") + (" some" if is_some else "")
    return f'<i class="{kind}" title="{end}">{_text(text)}</i>'


def _name(ladder: WorldLadder) -> str:
    return f"{ladder.parameter} {'−' if ladder.direction == '-' else ladder.direction}".strip()


def _text(text: str) -> str:
    return escape(LiveReport.legible(text))
