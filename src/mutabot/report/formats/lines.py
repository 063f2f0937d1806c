"""A line per mutant for ``grep``: keyword, number, place, operator, what it does, and why; tabs between.

The keyword is the state in capital letters (``SURVIVED``, ``KILLED``, ``NOT-COVERED`` …). The last line
begins with ``END``. ``mutabot run`` streams them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.report.mutant_data import end_data, lines_of, mutant_data
from mutabot.report.texts import one_line, places_text

if TYPE_CHECKING:
    from mutabot.report.format import Material
    from mutabot.results.results import MutantResult, Results


def make(material: Material) -> str:
    """Return the report."""
    return lines_of(material.campaign, mutant_line, end_line)


def mutant_line(result: MutantResult) -> str:
    """Return the line of a mutant."""
    data = mutant_data(result)
    place = one_line(places_text(result.mutant.site, lambda span: span.place))
    what = one_line(result.mutant.description)
    cells = (_keyword(data["status"]), str(data["number"]), place, data["operator"], what, data["why"])
    return "\t".join(cells)


def end_line(results: Results) -> str:
    """Return the last line: how the campaign ended, and counts of mutants."""
    data = end_data(results)
    counts = ", ".join(f"{count} {state}" for state, count in data["mutants"].items())
    return "\t".join(["END", data["state"], counts])


def _keyword(state: str) -> str:
    return state.upper().replace(" ", "-")
