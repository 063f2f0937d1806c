"""Workflow commands of GitHub Actions: each survivor is an annotation beside the line in a pull request.

A step shows at most ten warnings and ten notices: the survivors that matter most come first, and what is left
is in a last notice.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mutabot.errors import plural
from mutabot.report.texts import is_minor, survivor_text

if TYPE_CHECKING:
    from mutabot.report.format import Material
    from mutabot.results.results import MutantResult

#: annotations of each level; the tenth notice says what is not shown
_LIMITS = {"warning": 10, "notice": 9}


def make(material: Material) -> str:
    """Return the report: one command a line."""
    return "".join(f"{line}\n" for line in _lines(material))


def _lines(material: Material) -> Iterator[str]:
    left, hidden = dict(_LIMITS), 0
    for result in material.campaign.survivors:
        level = "notice" if is_minor(result) else "warning"
        if left[level]:
            left[level] -= 1
            yield _annotation(level, result, material)
        else:
            hidden += 1
    more = plural(hidden, "more survivor")
    notes = [f"not shown here: {more}; `mutabot results` lists all"] if hidden else []
    accepted = len(material.campaign.accepted)
    if accepted:
        notes.append(f"{accepted} accepted survivor{'s are' if accepted != 1 else ' is'} not shown")
    if not material.campaign.is_complete:
        campaign = material.campaign
        notes.append(f"the campaign is not complete ({campaign.state}): {campaign.known}")
    if notes:
        yield f"::notice title=mutabot::{_data('; '.join(notes))}"


def _annotation(level: str, result: MutantResult, material: Material) -> str:
    mutant = result.mutant
    span = mutant.site.span
    place = material.place(span)
    where = {"file": material.path(span.file), "line": str(place.line), "endLine": str(place.end_line)}
    if not mutant.site.is_in_file:  # the step as a whole has the annotation then
        where = {}
    elif place.end_column is not None and place.line == place.end_line:  # columns are of one line only
        where |= {"col": str(place.column), "endColumn": str(place.end_column)}
    where["title"] = f"Survivor {mutant.number}: {mutant.operator} ({mutant.site.role})"
    properties = ",".join(f"{name}={_property(value)}" for name, value in where.items())
    return f"::{level} {properties}::{_data(survivor_text(result))}"


def _data(text: str) -> str:
    """Return the message of a command, which ends with its line."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    """Return a value before the message, which also ends at a comma or at two colons."""
    return _data(text).replace(":", "%3A").replace(",", "%2C")
