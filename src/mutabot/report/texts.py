"""Texts for all formats: legible texts, the state of a mutant over its rounds, and excerpts.

``portable`` makes a whole campaign fit to leave the machine, so that none of its texts mentions that;
``escaped`` makes a text fit for Markdown. Other formats only have to escape what is special in them.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from typing import TYPE_CHECKING, Any, TypeVar, cast

from mutabot.journal.records import Reaching, Untested
from mutabot.model import Diverged, LeftOut, Mutant, Outcome, Quantity, Verdict
from mutabot.model.outcome_text import first_line, numbers_text
from mutabot.results.divergence import weight_of

if TYPE_CHECKING:
    from mutabot.model import Site, Span
    from mutabot.results.results import MutantResult, Results
    from mutabot.results.suggested import Suggestion

#: XML and strict JSON cannot hold these: controls, halves of surrogate pairs, and what is no character at all
_UNFIT = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufdd0-\ufdef\ufffe\uffff]")
ESCAPES = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07]*\x07|.)")
#: an absolute path in one of the folders in which machines keep files; topics of ROS look like others
_ABSOLUTE = re.compile(
    r"(?<![\w.~/…-])(?:file://)?/(?:home|root|tmp|usr|opt|var|etc|mnt|srv|nix|workspace|workspaces|builds|github|"
    r"__w|Users|private|Volumes|Library)(?:/[^\s/:;,'\"<>()\[\]{}|]+)*/(?=[^\s/:;,'\"<>()\[\]{}|])"
)

#: what helps where no probe shows how the world ended
_PROBE = "with a [[probe]] in the vocabulary that reads how the world ends"
#: what a mutant changed, as results say it before its effect
_CHANGE = re.compile(r"(?:sent|read|had) (.+?) instead of (.+?); ")


def legible(text: str) -> str:
    """Return a text of equal length in which characters that no format can hold are replaced."""
    return _UNFIT.sub("\N{REPLACEMENT CHARACTER}", text)


def one_line(text: str) -> str:
    """Return a text without line breaks and repeated blanks."""
    return " ".join(text.split())


class Cleaner:
    """Cleans messages for a report: legible, and without paths of the machine.

    What lies in the project is named from its folder on, any other file by its last name: ``…/decoder.py``.
    """

    def __init__(self, root: str | None) -> None:
        folder = (root or "").rstrip("/")
        self._root = re.compile(rf"(?:file://)?{re.escape(folder)}(?:/|(?![\w.-]))") if folder else None

    def __call__(self, text: str) -> str:
        text = ESCAPES.sub("", text)
        if self._root is not None:
            text = self._root.sub(lambda found: "" if found[0].endswith("/") else ".", text)
        return legible(_ABSOLUTE.sub("…/", text))


#: what begins a structure within a line: emphasis, code, links, images, tables, formulas, strikethrough
_SPECIAL = re.compile(r"([\\`*_\[\]|~$])")
#: what begins one at the start of a line
_START = re.compile(r"^(#+|[-+=]+)(?=\s|$)|^(\d+)([.)])(?=\s|$)")


#: a command of mutabot's in a text
_COMMAND = re.compile(r"(`mutabot(?: [\w.,…*=-]+)+`)")


def escaped(text: str) -> str:
    """Return a text as one line of Markdown that shows it unchanged, in any place; commands as code."""
    pieces = _COMMAND.split(one_line(text))
    return "".join(piece if number % 2 else _escaped(piece) for number, piece in enumerate(pieces))


def _escaped(line: str) -> str:
    line = line.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    line = _SPECIAL.sub(r"\\\1", line)
    # no link is made of an address that a program wrote
    line = line.replace("://", ":&#47;&#47;").replace("www.", "www&#46;")
    return _START.sub(lambda found: f"\\{found[1]}" if found[1] else f"{found[2]}\\{found[3]}", line)


T = TypeVar("T")

#: facts of a campaign that reveal nothing of the machine and its folders
_META = (
    "mutabot", "python", "versions", "seed", "rounds", "engine", "families", "order", "every_test", "started",
    "seconds", "selected_of",
)  # fmt: skip


def portable(campaign: Results) -> Results:
    """Return a copy of the campaign whose texts are fit for any report."""
    clean = Cleaner(campaign.meta.get("root"))
    texts = "state mutants graded controls flaky attempt verification left_out untested accepting"
    found: dict[str, Any] = {name: mapped(getattr(campaign, name), clean) for name in texts.split()}
    return replace(
        campaign,
        **found,
        meta=mapped({key: campaign.meta[key] for key in _META if key in campaign.meta}, clean),
        baseline=tuple(
            replace(row, test=replace(row.test, test=clean(row.test.test))) for row in campaign.baseline
        ),
        # a mark of the byte order is no part of the first line
        sources=mapped(
            {file: text.removeprefix("\ufeff") for file, text in campaign.sources.items()}, legible
        ),
        operators=mapped(campaign.operators, legible),
        reaching=Reaching(mapped(campaign.reaching.tests, clean), mapped(campaign.reaching.sites, legible)),
    )


#: what says what stands in the program, which stays as it is: it is the user's own text
_OWN = (Mutant, LeftOut, Untested)


def mapped(value: T, change: Callable[[str], str]) -> T:
    """Return the data with every text changed, including keys; in ids, only special characters."""
    return cast("T", _mapped(value, change))


def _mapped(value: Any, change: Callable[[str], str]) -> Any:
    if isinstance(value, Enum | Quantity):
        return value
    if isinstance(value, str):
        return change(value)
    if isinstance(value, Mapping):
        return {change(str(key)): _mapped(item, change) for key, item in value.items()}
    if isinstance(value, tuple | list):
        items = [_mapped(item, change) for item in value]
        return value._make(items) if hasattr(value, "_make") else type(value)(items)
    if is_dataclass(value) and not isinstance(value, type):
        change = legible if isinstance(value, _OWN) else change
        made = {field.name: _mapped(getattr(value, field.name), change) for field in fields(value)}
        if isinstance(value, Outcome):
            made["mutant"] = legible(value.mutant)
        return replace(value, **made)
    return value


#: the state of an accepted survivor, and of a mutant that has not been run
ACCEPTED, NOT_RUN = "accepted", "not run"


def state_of(result: MutantResult) -> str:
    """Return the state that a mutant is counted as: a verdict, *accepted* or *not run*."""
    return ACCEPTED if result.is_accepted else str(result.status or NOT_RUN)


def acceptance_text(result: MutantResult) -> str:
    """Return when and why it was accepted: ``accepted on 2026-01-31: the table is symmetric``; else empty."""
    found = result.acceptance
    if found is None or not result.is_accepted:
        return ""
    return f"accepted{f' on {found.date}' if found.date else ''}: {found.why}"


def rounds_text(result: MutantResult) -> str:
    """Return the rounds by outcome: ``killed by check in rounds 1 and 2, not run in rounds 3 to 6``."""
    by_end: dict[str, list[int]] = {}
    for number, outcome in enumerate(result.rounds, start=1):
        by_end.setdefault(_end(outcome), []).append(number)
    return ", ".join(f"{end} in {numbers_text(numbers)}" for end, numbers in by_end.items()) or "not run"


def reason_of(result: MutantResult) -> str:
    """Return why a mutant has its state: its rounds, a line about it, and a deciding test's message."""
    lines = [rounds_text(result), *filter(None, [acceptance_text(result)])]
    status = result.status
    if result.lets_through:
        lines.append(finding_text(result))
    given: set[str] = set()
    for outcome in result.outcomes:
        text = outcome.message or ""
        if text and text not in given and (not result.lets_through or outcome.verdict is not status):
            given.add(text)
            lines.append(f"round {outcome.round + 1}: {outcome.test + ': ' if outcome.test else ''}{text}")
    return "\n".join(lines)


def survivor_text(result: MutantResult) -> str:
    """Describe a survivor: what it does, in which rounds it survived, its effect, and what to do."""
    what = f"{result.mutant.description}{also_text(result.mutant.site)}"
    found = "; ".join(filter(None, [f"{what}: {rounds_text(result)}", finding_text(result)]))
    return ". ".join(filter(None, [found, next_step(result)]))


def is_minor(result: MutantResult) -> bool:
    """Return whether a survivor shows no weak check: accepted, indistinguishable, or reached by no test."""
    return result.is_accepted or result.indistinguishable or result.status is Verdict.NOT_COVERED


def next_step(result: MutantResult, suggestion: Suggestion | None = None) -> str:
    """Return what to do about a survivor; empty for other mutants, and for magnitudes of a ladder.

    Args:
        suggestion: what was suggested for it; None if nothing was looked for.
    """
    if not result.is_survivor or result.mutant.ladder:
        return ""
    if result.status is Verdict.NOT_COVERED:
        return f"Add a test that runs this line{' in every round' if result.kill_rate.killed else ''}."
    if suggestion is not None and suggestion.reason:
        return f"No check was found: {suggestion.reason}"
    number = result.mutant.number
    if result.indistinguishable:
        accept = f"accept it as an equivalent mutant: `mutabot accept {number} --why …`"
        return f"Add a probe or a test that would show a difference, or {accept}."
    search = f"Run `mutabot suggest --only {number}` to search for a check and verify it"
    return f"{search}; {_PROBE}, more are found." if result.is_unmeasured else f"{search}."


def next_steps(results: Results) -> str:
    """Return what to do about the survivors of a campaign; empty if no test that ran let one through."""
    survivors = [result for result in results.survivors if result.status is not Verdict.NOT_COVERED]
    if not survivors:
        return ""
    steps = [f"`mutabot show {survivors[0].mutant.number}` prints the details of a survivor"]
    to_check = [result for result in survivors if not result.indistinguishable]
    if to_check:
        steps.append("`mutabot suggest` searches for checks that kill survivors")
        if all(result.is_unmeasured for result in to_check):
            steps[-1] += f" and, {_PROBE}, finds more"
    return f"{', '.join(steps)}."


def also_text(site: Site) -> str:
    """Return the other places of a fault that has several, to follow the first one."""
    others = ", ".join(span.place for span in site.other_spans)
    return f" (also at {others})" if others else ""


def places_text(site: Site, place: Callable[[Span], str]) -> str:
    """Return all places of a site, a line each; ``place`` names a span for the reader."""
    return ",\n".join(map(place, site.spans))


def finding_text(result: MutantResult) -> str:
    """Return the line about a mutant, without what its description says, with the test and the round."""
    what = result.mutant.description
    why = result.why.removeprefix(f"{what}; ")
    change = _CHANGE.match(why)
    phrases = (f" {change[2]} → {change[1]}", f" {change[1]} instead of {change[2]}") if change else ()
    if change is not None and any(what.endswith(text) for text in phrases):
        why = why.removeprefix(change[0])
    number, diverged = most_informative(result) or (0, None)
    if diverged is not None and diverged.story and diverged.story in why:
        place = place_text(result, number, diverged)
        why += f" (in {place})" if place else ""
    return why


def effect_text(result: MutantResult) -> str:
    """Return the line about a mutant with the test in which it happened, and how many rounds killed it."""
    why, rate = finding_text(result), result.kill_rate
    uncovered = rate.valid - rate.killed - len(result.survived)
    if uncovered and (result.survived or rate.killed):
        why += f"{'; not covered' if result.survived else ''} in {uncovered} of {rate.valid} rounds"
    if result.lets_through and rate.killed:
        why += f"; killed in {rate.killed} of {rate.valid} rounds"
    return why


def most_informative(result: MutantResult) -> tuple[int, Diverged | None] | None:
    """Return the most informative round of a mutant, 0-based, and the test with the greatest effect.

    Of a survivor that is the round that let it through farthest from the original, which ``result.why`` is
    about too; else the first round with its state. None if it has not been run.
    """
    status = result.status
    outcomes = result.survived or [outcome for outcome in result.outcomes if outcome.verdict is status]
    if not outcomes:
        return next(((outcome.round, None) for outcome in result.outcomes), None)
    worst = max(outcomes, key=weight_of)
    return worst.round, worst.shown_difference


def place_text(result: MutantResult, number: int, diverged: Diverged) -> str:
    """Return the test of an effect if several ran, and the round if there are several."""
    outcome = result.rounds[number]
    test = diverged.test.rpartition("::")[2] if outcome is None or outcome.tests != 1 else ""
    return ", ".join(filter(None, (test, f"round {number + 1}" if len(result.rounds) > 1 else "")))


def short_reason(result: MutantResult) -> str:
    """Return why a mutant that has been run has its state, in a line, by the first such round."""
    status = result.status
    return next(first_line(outcome.message) for outcome in result.outcomes if outcome.verdict is status)


def _end(outcome: Outcome | None) -> str:
    if outcome is None:
        return "not run"
    return f"{outcome.verdict} by {outcome.by}" if outcome.by is not None else outcome.verdict.value


#: columns of a tab in an excerpt
_TAB = 4


def excerpts(site: Site, source: Callable[[str], str | None]) -> list[str]:
    """Return the lines around each place of a site; with several places, each with file and line.

    Args:
        source: the text of a file, or None if it is not known.
    """
    found = [(span, excerpt(text, span)) for span in site.spans if (text := source(span.file)) is not None]
    if not site.other_spans:
        return [line for _, lines in found for line in lines]
    return [line for span, lines in found if lines for line in (span.place, *lines)]


def excerpt(source: str, span: Span, *, around: int = 2) -> list[str]:
    """Return the lines of a span, marked with ``>``, and ``around`` lines before and after it."""
    lines = source.removesuffix("\n").split("\n")  # nothing else ends a line of a program
    if not 1 <= span.line <= len(lines):
        return []
    first, last = max(1, span.line - around), min(len(lines), span.end_line + around)
    return [
        f"{'>' if span.line <= number <= span.end_line else ' '} {number:>{len(str(last))}} │ "
        f"{lines[number - 1].expandtabs(_TAB)}".rstrip()
        for number in range(first, last + 1)
    ]
