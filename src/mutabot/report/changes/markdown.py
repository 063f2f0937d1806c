"""What differs between two campaigns, as a part of the Markdown report."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from mutabot.analysis.stored.changes import Changes
from mutabot.report.shaping.markup import escaped, table

from .sections import notes, score_rows, sections, summary

#: mutants of a section that are shown
_ROWS = 50


def change_lines(changes: Changes, path: Callable[[str], str]) -> Iterator[str]:
    """The lines. ``path`` names a file of the project as the reader knows it."""
    yield "### Since the older campaign"
    yield ""
    yield f"{summary(changes)}."
    yield ""
    for line in notes(changes):
        yield f"> **{escaped(line)}**"
        yield ""
    yield from table(("family · role", "old", "new", "points"), score_rows(changes), right=(1, 2, 3))
    for section in sections(changes):
        yield f"#### {section.heading}: {len(section.rows)}"
        yield ""
        rows = (
            (
                str(result.mutant.number),
                replace(result.mutant.site.span, file=path(result.mutant.site.span.file)).place,
                result.mutant.operator,
                result.mutant.description,
                told,
            )
            for result, told in section.rows[:_ROWS]
        )
        yield from table(("no.", "place", "operator", "what it does", "how it ended"), rows, right=(0,))
        if len(section.rows) > _ROWS:
            yield f"and {len(section.rows) - _ROWS} more"
            yield ""
