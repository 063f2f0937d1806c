"""Markdown for the summary of a CI job or a comment: the sections of the terminal, as tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from mutabot.report.sections import section_lines, sections, size_text
from mutabot.report.texts import escaped, next_steps

if TYPE_CHECKING:
    from mutabot.model import Span
    from mutabot.report.format import Material

#: rows of a table; GitHub takes no summary of more than a megabyte
_ROWS = 100


def make(material: Material) -> str:
    """Return the report."""
    return "\n".join(_lines(material)) + "\n"


def _lines(material: Material) -> Iterator[str]:
    campaign = material.campaign
    yield from (f"## Mutation testing: {size_text(campaign)}", "")
    if not campaign.is_complete or campaign.done < campaign.planned:
        yield from (
            f"> **This campaign is not complete** ({escaped(campaign.state)}): {campaign.known}.",
            "",
        )
    if not campaign.everything:
        yield from ("No mutants were planned." if campaign.is_complete else "No mutants are planned yet.", "")

    def place(span: Span) -> str:
        return replace(span, file=material.path(span.file)).place

    for section in sections(campaign, place):
        yield from section_lines(section, _ROWS)
    if steps := next_steps(campaign):
        yield from (steps, "")
