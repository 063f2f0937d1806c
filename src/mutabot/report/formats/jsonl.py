"""JSON Lines: an object per mutant, and a last one about the campaign. ``mutabot run`` streams them."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from mutabot.report.document import finite
from mutabot.report.mutant_data import end_data, lines_of, mutant_data

if TYPE_CHECKING:
    from mutabot.report.format import Material
    from mutabot.results.results import MutantResult, Results


def make(material: Material) -> str:
    """Return the report."""
    return lines_of(material.campaign, mutant_line, end_line)


def mutant_line(result: MutantResult) -> str:
    """Return the line of a mutant."""
    return _dumped({"event": "mutant", **mutant_data(result)})


def end_line(results: Results) -> str:
    """Return the last line: how the campaign ended, counts of mutants, scores, and what to do."""
    return _dumped({"event": "end", **end_data(results)})


def _dumped(data: dict[str, Any]) -> str:
    return json.dumps(finite(data), ensure_ascii=False, default=str)
