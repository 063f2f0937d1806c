"""What is suggested, on the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.text import Text

from mutabot.results.results import MutantResult
from mutabot.results.suggested import Suggestion, Suggestions, Unsolved

from .console import heading, plain, plural

#: dropped checks that are shown
_DROPPED = 5


def print_suggestions(console: Console, found: Suggestions) -> None:
    """Print what was found: each check with what it is worth, the diff, and what is left."""
    for part in _suggestion_parts(found):
        console.print(part)
    if found.diff:
        console.print()
        console.print(Text(found.diff.rstrip("\n")), soft_wrap=True)


def _suggestion_parts(found: Suggestions) -> Iterator[RenderableType]:
    killed = {mutant for one in found.suggestions for mutant in one.kills}
    survivors = len(killed) + len(found.unsolved)
    checks = plural(len(found.suggestions), "check")
    yield Text(f"{checks} for {len(killed)} of {plural(survivors, 'survivor')}", style="bold")
    for number, one in enumerate(found.suggestions, start=1):
        yield heading(f"{number}  {one.test}")
        for line in lines_of(one, found):
            yield Padding(Text(plain(line), overflow="fold"), (0, 0, 0, 3), expand=False)
    never = [one for one in found.unsolved if one.never]
    yield from _left("No check for", [one for one in found.unsolved if not one.never], found)
    yield from _left("No observation in these tests can kill", never, found)
    if found.dropped:
        yield heading(f"Dropped: {plural(len(found.dropped), 'check')} that failed the proof")
        for dropped in found.dropped[:_DROPPED]:
            yield Padding(Text(plain(f"{dropped.statement}: {dropped.reason}")), (0, 0, 0, 2), expand=False)
        if len(found.dropped) > _DROPPED:
            yield Text(f"  and {len(found.dropped) - _DROPPED} more (--json has all)")


def lines_of(one: Suggestion, found: Suggestions) -> Iterator[str]:
    """A check: the assertion, how sure it is, and what it kills."""
    yield one.statement
    yield f"{one.moment}; {_band(one)}"
    yield f"false alarms: {_alarms(one)}"
    yield f"kills {_kills(one, found)}"
    if one.by_hand:
        yield "another tool makes this test, so this is to be added by hand where it ends:"
        yield from (f"  {line}" for line in one.by_hand.splitlines())


def _band(one: Suggestion) -> str:
    if one.tolerance is None or not one.spread:
        return f"equal in {plural(one.runs, 'run')} of the original"
    factor = f", {one.factor:.1f} standard deviations" if one.factor is not None else ""
    return (
        f"within {one.tolerance:g} ({one.band}{factor}); {plural(one.runs, 'run')} of the original "
        f"spread {one.spread:.3g}"
    )


def _alarms(one: Suggestion) -> str:
    seen = f"none in {one.fresh} fresh seeds, which alone shows at most {_share_text(one.unseen)}"
    if one.factor is not None:
        return f"at most {_share_text(one.alarm)} of runs if the spread is normal; {seen} (95 % confidence)"
    return f"{seen}; the {one.runs} runs before show at most {_share_text(one.alarm)} (95 % confidence)"


def _share_text(share: float) -> str:
    return f"{100 * share:.2g} %"


def _kills(one: Suggestion, found: Suggestions) -> str:
    """The mutants by the rounds in which they are killed: ``#7, #9 in all rounds``."""
    by_rounds: dict[tuple[int, ...], list[int]] = {}
    for mutant, rounds in one.kills.items():
        by_rounds.setdefault(tuple(rounds), []).append(found.numbers.get(mutant, 0))
    parts = []
    for rounds, numbers in by_rounds.items():
        where = f" in round{'s' if len(rounds) > 1 else ''} {', '.join(str(one + 1) for one in rounds)}"
        if len(rounds) == found.rounds:
            where = " in all rounds" if found.rounds > 1 else ""
        parts.append(", ".join(f"#{number}" for number in sorted(numbers)) + where)
    return "; ".join(parts)


def _left(title: str, unsolved: Sequence[Unsolved], found: Suggestions) -> Iterator[RenderableType]:
    if not unsolved:
        return
    yield heading(f"{title} {plural(len(unsolved), 'survivor')}")
    for one in unsolved:
        text = f"#{found.numbers.get(one.mutant, 0)} {found.descriptions.get(one.mutant, '')}: {one.reason}"
        yield Padding(Text(plain(text), overflow="fold"), (0, 0, 0, 2), expand=False)


def suggested_parts(result: MutantResult, found: Suggestions | None) -> Iterator[RenderableType]:
    """The section of a survivor; nothing for other mutants."""
    if not result.is_survivor or result.mutant.ladder:
        return
    yield heading("A check that would catch it")
    for line in _would_catch(result, found):
        yield Padding(Text(plain(line), overflow="fold"), (0, 0, 0, 2), expand=False)


def _would_catch(result: MutantResult, found: Suggestions | None) -> Iterator[str]:
    mutant = result.mutant
    one = _check_for(result, found)
    if one is not None and found is not None:
        yield f"at the end of {one.test}:" if one.moment.startswith("end") else f"in {one.test}:"
        yield from lines_of(one, found)
        if not one.by_hand:
            yield "`mutabot suggest` prints it as a diff."
        return
    reasons = {one.mutant: one.reason for one in found.unsolved} if found is not None else {}
    if mutant.id in reasons:
        yield f"none was found: {reasons[mutant.id]}"
    elif result.indistinguishable:
        yield "nothing differs that was compared: it needs another probe or another test, or is no fault"
    else:
        yield f"`mutabot suggest --only {mutant.number}` looks for one, and proves it"


def _check_for(result: MutantResult, found: Suggestions | None) -> Suggestion | None:
    """The check that was suggested for a mutant."""
    suggestions = found.suggestions if found is not None else ()
    return next((one for one in suggestions if result.mutant.id in one.kills), None)


def check_on_page(result: MutantResult, found: Suggestions | None) -> dict[str, Any] | None:
    """The same as the mutant's page has it; None if there is none."""
    one = _check_for(result, found)
    if one is None or found is None:
        return None
    statement, *notes = lines_of(one, found)
    return {"code": statement, "test": one.test, "notes": notes}
