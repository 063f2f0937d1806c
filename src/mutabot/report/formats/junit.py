"""JUnit XML: a test case per mutant, which CI systems show. A survivor that is not accepted is a failure."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING
from xml.etree import ElementTree as Xml

from mutabot.model import Verdict
from mutabot.report.texts import (
    ACCEPTED,
    NOT_RUN,
    acceptance_text,
    finding_text,
    next_step,
    one_line,
    places_text,
    reason_of,
    rounds_text,
    short_reason,
    state_of,
)

if TYPE_CHECKING:
    from mutabot.report.format import Material
    from mutabot.results.results import MutantResult

#: state to the element that says so; states that are not here passed
_ELEMENT: Mapping[str, str] = {
    Verdict.SURVIVED: "failure",
    Verdict.NOT_COVERED: "failure",
    Verdict.ERROR: "error",
    Verdict.UNSTABLE: "error",
    Verdict.REFUSED: "skipped",
    Verdict.GUARDED: "skipped",
    Verdict.INVALID: "skipped",
    Verdict.NO_EFFECT: "skipped",
    ACCEPTED: "skipped",
    NOT_RUN: "skipped",
}


def make(material: Material) -> str:
    """Return the report."""
    campaign = material.campaign
    suites: dict[tuple[str, str, str], list[MutantResult]] = {}
    for result in campaign.mutants:
        site = result.mutant.site
        suites.setdefault((site.span.file, result.mutant.family, site.role.value), []).append(result)
    groups = {(group.family, group.role): group for group in campaign.groups}
    root = Xml.Element("testsuites", {"name": f"mutabot ({campaign.state})", **_counts(campaign.mutants)})
    for (file, family, role), results in suites.items():
        name = f"{material.path(file)} · {family} · {role}"
        suite = Xml.SubElement(root, "testsuite", {"name": name, **_counts(results)})
        group = groups.get((family, role))
        if group is not None:  # over all files, as in every other report
            found = {"score": group.scores.mean, "check_score": group.scores.mean_check}
            properties = Xml.SubElement(suite, "properties")
            for name, share in found.items():
                value = "" if share is None else f"{share:.4f}"
                Xml.SubElement(properties, "property", {"name": name, "value": value})
        for result in results:
            _case(suite, result, material)
    Xml.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Xml.tostring(root, encoding="unicode") + "\n"


def _counts(results: Sequence[MutantResult]) -> dict[str, str]:
    elements = [_ELEMENT.get(state_of(result)) for result in results]
    return {
        "tests": str(len(results)),
        "failures": str(elements.count("failure")),
        "errors": str(elements.count("error")),
        "skipped": str(elements.count("skipped")),
        "time": _seconds(results),
    }


def _seconds(results: Iterable[MutantResult]) -> str:
    return f"{sum(outcome.wall for result in results for outcome in result.outcomes):.3f}"


def _case(suite: Xml.Element, result: MutantResult, material: Material) -> None:
    mutant = result.mutant
    file = material.path(mutant.site.span.file)
    case = Xml.SubElement(
        suite,
        "testcase",
        {
            # together they name the mutant in every campaign: the id begins with its file
            "classname": f"mutabot.{mutant.family}.{mutant.site.role.value}",
            "name": mutant.id,
            "file": file,
            "line": str(mutant.site.span.line),
            "time": _seconds([result]),
        },
    )
    state = state_of(result)
    element = _ELEMENT.get(state)
    place = places_text(mutant.site, lambda span: replace(span, file=material.path(span.file)).place)
    text = f"{one_line(place)}: {mutant.operator}: {mutant.description}\n{reason_of(result)}"
    if element is None:
        Xml.SubElement(case, "system-out").text = text
        return
    reason = f": {short_reason(result)}" if state != NOT_RUN else ""
    ended = acceptance_text(result) or f"{rounds_text(result)}{reason}"
    why = finding_text(result) if element == "failure" else ended
    child = Xml.SubElement(case, element, {"message": one_line(f"{mutant.description}: {why}")})
    if element != "skipped":
        child.set("type", state.replace(" ", "-"))
    child.text = "\n".join(filter(None, [text, next_step(result)]))
