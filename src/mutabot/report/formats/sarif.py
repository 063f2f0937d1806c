"""SARIF 2.1.0: a result per survivor, for code scanning and editors; accepted ones are suppressed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from mutabot.errors import in_short
from mutabot.report.document import dumps
from mutabot.report.format import Material, utf16
from mutabot.report.texts import is_minor, survivor_text

if TYPE_CHECKING:
    from mutabot.model import Mutant, Site, Span
    from mutabot.model.suppression import Acceptance
    from mutabot.results.results import MutantResult

_SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
#: paths are relative to this, which the reader of the file resolves
_ROOT = "%SRCROOT%"
#: part of a name in ``partialFingerprints``; rises if ids of mutants are made in another way
_FINGERPRINT = "mutabotMutant/v1"
#: names of each kind that a note gives
_NAMES = 20
_HELP = (
    "A survivor is a fault that the test suite lets through. Add a check that notices what the robot does "
    "otherwise, or a case in which the fault matters; `mutabot show ID` prints its details."
)


def make(material: Material) -> str:
    """Return the report."""
    survivors = [*material.campaign.survivors, *material.campaign.accepted]
    rules = {
        name: index for index, name in enumerate(sorted({survivor.mutant.operator for survivor in survivors}))
    }
    return dumps(
        {
            "$schema": _SCHEMA,
            "version": "2.1.0",
            "runs": [
                {
                    "tool": {"driver": _driver(material, rules)},
                    "automationDetails": {"id": "mutabot/"},
                    "columnKind": "utf16CodeUnits",
                    "originalUriBaseIds": {_ROOT: {"description": {"text": "The root of the repository."}}},
                    "invocations": [_invocation(material)],
                    "results": [_result(survivor, material, rules) for survivor in survivors],
                }
            ],
        }
    )


def _driver(material: Material, rules: Mapping[str, int]) -> dict[str, Any]:
    version = str(material.campaign.meta.get("mutabot", ""))
    survivors = [*material.campaign.survivors, *material.campaign.accepted]
    known = {survivor.mutant.operator: survivor.mutant for survivor in survivors}
    return {
        "name": "Mutabot",
        **({"version": version} if version else {}),
        "rules": [_rule(name, known[name], material) for name in rules],
    }


def _rule(name: str, mutant: Mutant, material: Material) -> dict[str, Any]:
    summary = material.campaign.operators.get(name) or f"Operator {name} of family {mutant.family}."
    return {
        "id": name,
        "shortDescription": {
            "text": _message(f"{summary.partition('. ')[0].rstrip('.')}: no test notices it")
        },
        "fullDescription": {"text": _message(summary)},
        "help": {"text": _message(f"{summary}\n\n{_HELP}")},
        "properties": {"tags": ["mutation-testing", mutant.family]},
    }


def _invocation(material: Material) -> dict[str, Any]:
    campaign = material.campaign
    is_complete = campaign.is_complete
    state = f"{campaign.state}: {campaign.known}"
    notes = [] if is_complete else [{"level": "warning", "message": {"text": _message(state)}}]
    if campaign.confirmation is not None:
        notes.append({"level": "note", "message": {"text": _message(f"{campaign.confirmation.text}.")}})
    untested = campaign.untested
    if untested.text:
        named = "; ".join(f"{what}: {in_short(names, _NAMES)}" for what, names in untested.named.items())
        notes.append({"level": "warning", "message": {"text": _message(f"{untested.text}. {named}")}})
    return {"executionSuccessful": is_complete, "toolExecutionNotifications": notes}


def _result(result: MutantResult, material: Material, rules: Mapping[str, int]) -> dict[str, Any]:
    mutant = result.mutant
    return {
        "ruleId": mutant.operator,
        "ruleIndex": rules[mutant.operator],
        "level": _level(result),
        "message": {"text": _message(survivor_text(result))},
        "locations": [_location(mutant.site, material)],
        **_related(mutant.site, material),
        "partialFingerprints": {_FINGERPRINT: mutant.id},
        "properties": {"mutant": mutant.id, "number": mutant.number},
        **_suppressions(result.acceptance),
    }


def _suppressions(acceptance: Acceptance | None) -> dict[str, Any]:
    """Return a survivor's acceptance, so that code scanning hides the survivor."""
    if acceptance is None:
        return {}
    kind = "inSource" if acceptance.in_source else "external"
    reason = f"{acceptance.why} ({acceptance.source})"
    return {"suppressions": [{"kind": kind, "status": "accepted", "justification": reason}]}


def _level(result: MutantResult) -> str:
    """Return a survivor's level, which is higher if the robot acted differently."""
    if is_minor(result):
        return "note"
    differs = any(outcome.divergence and not outcome.indistinguishable for outcome in result.survived)
    return "error" if differs else "warning"


def _location(site: Site, material: Material) -> dict[str, Any]:
    if not site.is_in_file:
        return {"logicalLocations": [{"fullyQualifiedName": site.id, "kind": "variable"}]}
    function = site.span.function or site.id
    return {
        "physicalLocation": _region(site.span, material),
        "logicalLocations": [
            {"fullyQualifiedName": function, **({"kind": "function"} if site.span.function else {})}
        ],
    }


def _related(site: Site, material: Material) -> dict[str, Any]:
    """Return the other places of a fault that has several."""
    spans = site.other_spans
    found = [{"id": number, "physicalLocation": _region(span, material)} for number, span in enumerate(spans)]
    return {"relatedLocations": found} if found else {}


def _region(span: Span, material: Material) -> dict[str, Any]:
    place = material.place(span, utf16)
    region: dict[str, Any] = {"startLine": place.line, "endLine": place.end_line}
    if place.text is not None:
        region |= {
            "startColumn": place.column,
            "endColumn": place.end_column,
            "snippet": {"text": place.text},
        }
    file = {"uri": quote(material.path(span.file)), "uriBaseId": _ROOT}
    return {"artifactLocation": file, "region": region}


def _message(text: str) -> str:
    """Plain text for ``message.text``, in which braces stand for arguments and ``[…](…)`` for a link."""
    return text.replace("{", "{{").replace("}", "}}").replace("](", "] (")
