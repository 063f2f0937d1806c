"""Markdown for the summary of a CI job or a comment: scores, survivors, and what is not judged."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from mutabot.model import Verdict
from mutabot.report.changes import change_lines
from mutabot.report.format import Format, Material
from mutabot.report.terminal.console import between, percent
from mutabot.report.texts import OUTSIDE, escaped, rounds_text, short_reason, status_of, table, why_alone
from mutabot.results.results import MutantResult
from mutabot.results.score import Group
from mutabot.results.statistics import Interval
from mutabot.results.thresholds import line_of, thresholds_of

#: rows of a table of mutants; GitHub takes no summary of more than a megabyte
_ROWS = 100
#: rows of the table of ladders
_LADDERS = 50


def make(material: Material) -> str:
    """The report."""
    return "\n".join(_lines(material)) + "\n"


def _lines(material: Material) -> Iterator[str]:
    campaign = material.campaign
    graded = f"{' and' if campaign.mutants else ''} {campaign.ladders} ladders" if campaign.ladders else ""
    mutants = f" {len(campaign.mutants)} mutants" if campaign.mutants or not graded else ""
    yield f"## Mutation testing:{mutants}{graded} × {campaign.rounds} rounds"
    yield ""
    if not campaign.is_complete or campaign.done < campaign.planned:
        yield f"> **This campaign is not complete** ({escaped(campaign.state)}): {campaign.known}."
        yield ""
    if not campaign.groups and campaign.ladders:
        yield "Graded mutants alone, which have no score."
        yield ""
    elif not campaign.groups:
        is_early = not campaign.is_complete
        yield "No mutants are planned yet." if is_early else "No mutants were planned."
    else:
        yield from _scores(campaign.groups)
    if campaign.confirmation is not None:
        yield f"{campaign.confirmation.text}."
        yield ""
    if material.changes is not None:
        yield from change_lines(material.changes, material.path)
    yield from _survivors(material)
    yield from _thresholds(material)
    yield from _unjudged(material)
    yield from _left_out(material)
    yield from _flaky(campaign.flaky.tests)


def _scores(groups: Sequence[Group]) -> Iterator[str]:
    head = ("family", "role", "mutants", "score", "killed / valid", "check score", "by a check / valid")
    yield from table(head, (_score_cells(group) for group in groups), right=range(2, 7))


def _score_cells(group: Group) -> tuple[str, ...]:
    scores, total = group.scores, group.scores.total
    return (
        group.family,
        group.role,
        str(group.mutants),
        _percent(scores.mean, scores.interval),
        f"{total.killed} / {total.valid}",
        _percent(scores.mean_check, scores.check_interval),
        f"{total.by_check} / {total.valid}",
    )


def _percent(share: float | None, interval: Interval | None) -> str:
    ends = f" ({between(interval)})" if share is not None and interval is not None else ""
    return f"{percent(share)}{ends}"


def _survivors(material: Material) -> Iterator[str]:
    survivors = material.campaign.survivors
    if not survivors:
        if material.campaign.all.total.valid:
            yield "### No survivors" if material.campaign.is_complete else "### No survivors so far"
            yield ""
        return
    yield f"### Survivors: {len(survivors)}, the farthest from the original first"
    yield ""
    head = ("no.", "place", "operator", "what it does", "let through", "why")
    yield from table(head, (_survivor_cells(one, material) for one in survivors[:_ROWS]), right=(0,))
    yield from _rest(len(survivors))


def _survivor_cells(result: MutantResult, material: Material) -> tuple[str, ...]:
    mutant, rate = result.mutant, result.kill_rate
    return (
        str(mutant.number),
        _place(result, material),
        mutant.operator,
        mutant.description,
        f"{rate.valid - rate.killed} of {rate.valid}",
        why_alone(result),
    )


def _thresholds(material: Material) -> Iterator[str]:
    """The loosest ladders of graded mutants."""
    ladders = thresholds_of(material.campaign).ladders
    if not ladders:
        return
    yield f"### How big a fault must be before the tests notice: {len(ladders)} ladders, the loosest first"
    yield ""
    head = ("place", "what", "noticed")
    rows = ((material.path(one.place), one.name, line_of(one)) for one in ladders[:_LADDERS])
    yield from table(head, rows)
    if len(ladders) > _LADDERS:
        yield f"and {len(ladders) - _LADDERS} more, which `mutabot thresholds` lists."
        yield ""


def _place(result: MutantResult, material: Material) -> str:
    span = result.mutant.site.span
    return replace(span, file=material.path(span.file)).place


def _rest(count: int) -> Iterator[str]:
    if count > _ROWS:
        yield f"and {count - _ROWS} more, which `mutabot results` lists."
        yield ""


def _unjudged(material: Material) -> Iterator[str]:
    by_status: dict[Verdict | None, list[MutantResult]] = {}
    for result in material.campaign.mutants:
        by_status.setdefault(status_of(result), []).append(result)
    if None in by_status:
        yield f"Mutants that have not been run: {len(by_status[None])}."
        yield ""
    found = [one for status in OUTSIDE for one in by_status.get(status, ())]
    if not found:
        return
    yield f"### Not judged: {len(found)}, outside the score"
    yield ""
    head = ("no.", "place", "operator", "what it does", "rounds", "reason")
    rows = (
        (
            str(one.mutant.number),
            _place(one, material),
            one.mutant.operator,
            one.mutant.description,
            rounds_text(one),
            short_reason(one),
        )
        for one in found[:_ROWS]
    )
    yield from table(head, rows, right=(0,))
    yield from _rest(len(found))


def _left_out(material: Material) -> Iterator[str]:
    left_out = material.campaign.left_out
    if left_out:
        reasons = Counter(item.reason for item in left_out).most_common()
        told = "; ".join(f"{count} × {escaped(reason)}" for reason, count in reasons)
        yield f"Left out, because they cannot matter: {len(left_out)} ({told})."
        yield ""


def _flaky(tests: Iterable[str]) -> Iterator[str]:
    lines = [f"- {escaped(line)}" for line in tests]
    if lines:
        yield "### Tests that cannot be relied on"
        yield ""
        yield from lines
        yield ""


FORMAT = Format("markdown", make, tells_changes=True)
