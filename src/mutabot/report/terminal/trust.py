"""How far a campaign is to be relied on: errors, its limits, flaky tests, repeats and controls."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.console import RenderableType
from rich.padding import Padding
from rich.text import Text

from mutabot.journal.records import REMARKS, Repeated, Repeats
from mutabot.model import Verdict
from mutabot.report.terminal.console import heading, plain, plural
from mutabot.results.divergence import first_line
from mutabot.results.results import Results
from mutabot.results.statistics import Estimate, false_kills, false_survivors

#: numbers of mutants that a line gives, and lines for different messages
_NUMBERS, _MESSAGES = 10, 8


def error_lines(results: Results) -> Iterator[RenderableType]:
    """How many outcomes are errors, and one line per message with the mutants it is about."""
    found: dict[str, list[int]] = {}
    for result in results.everything:
        for outcome in result.outcomes:
            if outcome.verdict is Verdict.ERROR:
                found.setdefault(first_line(outcome.message), []).append(result.mutant.number)
    count = sum(map(len, found.values()))
    if not count:
        return
    run = sum(len(result.outcomes) for result in results.everything)
    text = f"\n{count} of {plural(run, 'outcome')} ended in error, so nothing is known of them"
    yield Text(text, style="bold red")
    ranked = sorted(found.items(), key=lambda item: -len(item[1]))
    for message, numbers in ranked[:_MESSAGES]:
        line = f"{len(numbers)} × {plain(message)} ({_mutants(numbers)})"
        yield Padding(Text(line, overflow="fold"), (0, 0, 0, 2))
    if len(ranked) > _MESSAGES:
        yield Padding(Text(f"and {len(ranked) - _MESSAGES} more messages"), (0, 0, 0, 2))


def _mutants(numbers: list[int]) -> str:
    different = list(dict.fromkeys(numbers))
    shown = ", ".join(str(number) for number in different[:_NUMBERS])
    more = f" and {len(different) - _NUMBERS} more" if len(different) > _NUMBERS else ""
    return f"mutant{'s' if len(different) > 1 else ''} {shown}{more}"


def since_lines(results: Results) -> Iterator[RenderableType]:
    """What was run of what has changed, and what the scores are of."""
    since = results.since
    if since is None:
        return
    run, unjudged = sum(since.run.values()), sum(since.not_judged.values())
    text = f"Since {since.ref} ({since.commit[:7]}): {run} run, {since.taken_over} taken over"
    yield heading(plain(text + (f", {unjudged} not judged" if unjudged else "")))
    for why, count in since.run.items():
        yield Text(f"{count} run: {why}", overflow="fold")
    for why, count in since.not_judged.items():
        yield Text(f"{count} not judged, though no change can have altered them: {why}", overflow="fold")
    if unjudged:
        yield Text("Scores are of those that were run or taken over, not of all mutants.", overflow="fold")


def budget_lines(results: Results) -> Iterator[RenderableType]:
    """What the time was enough for, and what the scores are of."""
    budget = results.budget
    if budget is None or budget.is_whole:
        return
    run = budget.run + budget.cut_off
    yield heading(f"Time for {run} of {plural(budget.planned, 'outcome')}; {budget.planned - run} not run")
    yield Text("Scores are of those that were run, survivors of earlier runs first.", overflow="fold")
    if budget.cut_off:
        text = f"{budget.cut_off} are from the batch that was cut off, in which kills end before survivors."
        yield Text(text, overflow="fold")


_SET_ASIDE = "The journal holds what mutabot has not written, or what is damaged; it counts as not run:"
_ALTERED = "Something else changed the journal while the campaign ran; what mutabot had found was restored:"
#: rows of a journal that are named
_ROWS = 8


def trust_lines(results: Results) -> Iterator[RenderableType]:
    """Flaky tests, and what a second look at outcomes found."""
    if results.flaky.tests:
        yield heading(f"{plural(len(results.flaky.tests), 'test')} set aside, which cannot be relied on")
        for line in results.flaky.tests:
            yield Text(plain(line), overflow="fold")
    yield from _journal_lines(_SET_ASIDE, results.set_aside)
    yield from _journal_lines(_ALTERED, results.altered)
    for remark in results.meta.get(REMARKS) or ():
        yield Text(f"\n{plain(remark)}", style="bold", overflow="fold")
    confirmed = results.confirmation
    if confirmed is not None:
        style = "bold red" if confirmed.wrong else "bold"
        yield Text(f"\n{confirmed.text}.", style=style, overflow="fold")
    checked = results.verification
    if checked is not None:
        text = f"\nVerified: {checked.agreed} of {checked.checked} outcomes end the same in fresh processes."
        yield Text(text, style="bold red" if checked.disagreements else "dim")
        for one in checked.disagreements:
            words = f"mutant {one.number}, round {one.round + 1}: {one.first}; afresh: {one.second}"
            yield Padding(Text(plain(words), overflow="fold"), (0, 0, 0, 2))
    yield from repeat_lines(results.repeats)


def _journal_lines(told: str, rows: Sequence[str]) -> Iterator[RenderableType]:
    """What others did to the journal."""
    if not rows:
        return
    yield Text(f"\n{told}", style="bold red", overflow="fold")
    more = [f"and {len(rows) - _ROWS} more"] if len(rows) > _ROWS else []
    for line in [*rows[:_ROWS], *more]:
        yield Padding(Text(plain(line), overflow="fold"), (0, 0, 0, 2))


def control_lines(results: Results) -> Iterator[RenderableType]:
    """Whether the control mutants ended as they must."""
    if not results.controls:
        return
    wrong = [control for control in results.controls if not control.ok]
    if not wrong:
        files = {control.test_file.partition("::")[0] for control in results.controls}
        yield Text(f"\nControls ended as they must in {plural(len(files), 'test file')}.", style="dim")
    for control in wrong:
        text = f"\nThe {control.control} control of {control.test_file} ended wrongly: {control.detail}"
        yield Text(text, style="bold red")


def repeat_lines(repeats: Repeats) -> Iterator[Text]:
    """How many outcomes were run once more, and how many of the others may be wrong; nothing if none was."""
    doubted, others, survivors = repeats.doubted, repeats.others, repeats.survivors
    if doubted.outcomes or others.repeated:
        yield _repeat_text(
            _kills_text(doubted, others, false_kills(repeats)), doubted.changed + others.changed
        )
    if survivors.repeated:
        found = false_survivors(repeats)
        text = f"Survivors: {_repeated(survivors)}; {_estimate('false survivors', found)}."
        yield _repeat_text(text, survivors.changed)


def _kills_text(doubted: Repeated, others: Repeated, found: Estimate | None) -> str:
    parts = []
    if doubted.outcomes:
        left = f", {doubted.left} were not" if doubted.left else ""
        parts.append(f"of {plural(doubted.outcomes, 'kill')} that may be chance {_repeated(doubted)}{left}")
    if others.repeated:
        parts.append(f"of {plural(others.outcomes, 'other')} {_repeated(others)}")
    parts.append(_estimate("false kills", found))
    if others.outcomes and not others.repeated:
        text = f"{plural(others.outcomes, 'other kill')} by tests without simulated time were not repeated"
        parts.append(f"{text} (--verify N repeats some)")
    return f"Kills: {'; '.join(parts)}."


def _repeated(stratum: Repeated) -> str:
    return f"{stratum.repeated} were run once more, {stratum.changed} ended otherwise and count no more"


def _estimate(what: str, found: Estimate | None) -> str:
    if found is None:
        return f"how many {what} there are is not known"
    return f"{what} left among {found.known}: {found.expected:.1f} ({found.low} to {found.high})"


def _repeat_text(text: str, changed: int) -> Text:
    return Text(f"\n{text}", style="bold red" if changed else "dim", overflow="fold")
