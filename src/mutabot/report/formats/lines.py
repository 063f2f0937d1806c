"""A line per mutant for ``grep``: keyword, number, place, operator, what it does, and why; tabs between.

The keyword is the state in capital letters (``SURVIVED``, ``KILLED``, ``NOT-COVERED`` …). The last line
begins with ``END``. ``mutabot run`` streams them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

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
    keyword = data["status"].upper().replace(" ", "-")
    cells = (keyword, str(data["number"]), place, data["operator"], what, data["effect"])
    return "\t".join(cells)


def end_line(results: Results) -> str:
    """Return the last line: how the campaign ended, counts of mutants, scores, and further remarks.

    These are what no test reaches, and what to do about survivors, which begins with ``next:``.
    """
    data = end_data(results)
    counts = ", ".join(f"{count} {state}" for state, count in data["mutants"].items())
    scores = ", ".join(map(_score, data["scores"]))
    step = f"next: {data['next']}" if data["next"] else ""
    return "\t".join(["END", data["state"], counts, scores, *filter(None, [data["untested"], step])])


def _score(group: Mapping[str, Any]) -> str:
    shares = (
        "none" if share is None else f"{100 * share:.1f} %"
        for share in (group["score"], group["check_score"])
    )
    return f"{group['family']} {group['role']} {' by check '.join(shares)}"
