"""Print one mutant on the terminal: the main facts on one screen, or everything."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from math import inf
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from mutabot.errors import plural
from mutabot.model.outcome_text import describe_end, numbers_text
from mutabot.report.sections import Section, between
from mutabot.report.texts import (
    acceptance_text,
    effect_text,
    excerpts,
    most_informative,
    next_step,
    places_text,
)

from .console import (
    Breakable,
    below,
    heading,
    letters,
    make_table,
    mark_of,
    marks_of,
    print_section,
    terminal_text,
)

if TYPE_CHECKING:
    from mutabot.journal.records import Replayed
    from mutabot.model import Diverged, Mutant, Outcome, Quantity
    from mutabot.results.results import MutantResult
    from mutabot.results.suggested import Suggestion

#: lines of a message, and checks, on the one screen; the journal and JSON have more
_LINES, _CHECKS = 8, 3


def print_mutant(
    console: Console,
    result: MutantResult,
    source: Callable[[str], str | None],
    suggestion: Suggestion | None = None,
    *,
    everything: bool = False,
) -> None:
    """Print one mutant.

    Args:
        source: the text of a file, or None if it is not known.
        suggestion: what was suggested for it; None if nothing was looked for.
        everything: print every round.
    """
    mutant = result.mutant
    console.print(
        Text(f"Mutant {mutant.number}: {terminal_text(mutant.description)}", style="bold", overflow="fold")
    )
    console.print(_facts(result))
    lines = excerpts(mutant.site, source)
    if lines:
        text = "\n" + "\n".join(terminal_text(line) for line in lines)
        console.print(Text(text, no_wrap=True, overflow="ellipsis"))
    rounds, checks = _rounds(result, everything=everything), [*_checks(result, everything=everything)]
    for section in (rounds, *_happened(result), *checks, *suggested_sections(result, suggestion)):
        print_section(console, section)
    hidden = "rounds" if len(result.rounds) > 1 else "lines of the round"
    more = [hidden] if rounds != _rounds(result, everything=True) else []
    more += ["checks"] if checks != [*_checks(result, everything=True)] else []
    if more:
        console.print(Text(f"\nUse --all for all {' and '.join(more)}.", style="dim"))


def print_replayed(console: Console, mutant: Mutant, rounds: Iterable[Replayed]) -> None:
    """Print how a mutant ended when it was re-run, beside what the journal says."""
    states = {True: "as in the journal", False: "not as in the journal", None: "not in the journal"}
    console.print(
        Text(f"Mutant {mutant.number}: {terminal_text(mutant.description)}", style="bold", overflow="fold")
    )
    for replayed in rounds:
        console.print(heading(f"Round {replayed.round + 1}: {states[replayed.agrees]}"))
        ends = [("now", replayed.second)]
        if replayed.first is not None and not replayed.agrees:
            ends.append((f"in the journal ({replayed.first.engine})", replayed.first))
        for name, outcome in ends:
            console.print(below("\n".join([f"{name}: {describe_end(outcome)}", *_details(outcome)])))


def _facts(result: MutantResult) -> Table:
    mutant, rate = result.mutant, result.kill_rate
    place, function = places_text(mutant.site, lambda span: span.place), mutant.site.span.function
    of_rounds = f"in {rate.killed} of {plural(rate.valid, 'valid round')}"
    interval = f", 95 % interval {between(rate.interval)}" if rate.interval is not None else ""
    command = f", command {mutant.pattern_name}" if mutant.pattern else ""
    facts = {
        "id": mutant.id,
        "place": f"{place} in {function}" if function else place,
        "operator": f"{mutant.operator} ({mutant.family}, {mutant.site.role})",
        "operation": f"{mutant.operation}{command}",
        "quantity": _quantity_text(mutant.quantity, result.quantity) if mutant.operation else "",
        "change": f"the {mutant.site.role} {result.change}" if result.change is not None else "",
        "killed": of_rounds + interval,
        "result": effect_text(result),
        "accepted": acceptance_text(result).removeprefix("accepted").removeprefix(": ").strip(),
    }
    table = make_table(("", "*"), header=False)
    for name, text in facts.items():
        if text:
            table.add_row(Text(name, style="dim"), Breakable(terminal_text(text)))
    return table


def _quantity_text(name: str | None, quantity: Quantity | None) -> str:
    if name is None or quantity is None:
        return name or "the call as a whole"
    details = (
        quantity.kind.value,
        quantity.axis,
        quantity.unit,
        quantity.frame and f"frame {quantity.frame}",
    )
    return f"{name}: {', '.join(word for word in details if word)}"


def _rounds(result: MutantResult, *, everything: bool) -> Section:
    """Return the rounds, equal ones together with the details of the first; on one screen only a few."""
    groups: dict[Any, list[int]] = {}
    for number, outcome in enumerate(result.rounds):
        groups.setdefault(outcome and (describe_end(outcome), outcome.place), []).append(number)
    most = most_informative(result)
    lines = [letters(marks_of(result)).plain] if len(result.rounds) > 1 else []
    for numbers in groups.values():
        outcome = result.rounds[most[0] if most is not None and most[0] in numbers else numbers[0]]
        if everything or most is None or most[0] in numbers:
            test = f" in {outcome.test}" if outcome is not None and outcome.test is not None else ""
            mark = mark_of(outcome)
            lines.append(f"{numbers_text(number + 1 for number in numbers)}: {mark.letter} {mark.text}{test}")
            details = "\n".join(_details(outcome)).splitlines() if outcome is not None else []
            lines += (f"    {line}" for line in (details if everything else details[:_LINES]))
    if len(groups) > 1 and most is not None:
        lines.append(
            f"`mutabot replay {result.mutant.number} --round {most[0] + 1}` re-runs it as in that round"
        )
    return Section("Rounds", lines=lines)


def _details(outcome: Outcome) -> Iterator[str]:
    if outcome.message:
        exception = f"{outcome.exception.rpartition(':')[2]}: " if outcome.exception else ""
        yield f"{exception}{outcome.message.rstrip()}"
    if outcome.place is not None:
        yield f"at {outcome.place}"
    acted = f"acted at {outcome.acted} of {plural(outcome.hits, 'hit')}"
    yield f"{acted}, {plural(outcome.tests, 'test')} run, {outcome.wall:.1f} s"
    yield from (f"left {plural(count, 'call')} unchanged: {why}" for why, count in outcome.away.items())
    if outcome.compared is not None:
        equal = "no difference" if outcome.indistinguishable else "compared with the original"
        yield f"{equal} in {outcome.compared.text}"
    yield from outcome.divergence
    yield from (f"not compared: {gap}" for gap in outcome.gaps)
    if outcome.confirmed is not None:
        yield f"{'' if outcome.confirmed else 'not '}confirmed by the whole suite"
    if outcome.beside is not None:
        yield f"re-run alone, because beside others it exceeded the wall clock: {outcome.beside}"


def _happened(result: MutantResult) -> Iterator[Section]:
    """Yield what the robot did in the most informative round and test; nothing without recordings."""
    number, diverged = most_informative(result) or (0, None)
    if diverged is None:
        return
    title = f"What the robot did (round {number + 1}, {diverged.test})"
    yield Section(title, lines=[*_sentences(diverged)])


def _sentences(diverged: Diverged) -> Iterator[str]:
    if diverged.story:
        yield f"{diverged.story[0].upper()}{diverged.story[1:]}."
    if diverged.what:
        clock = "" if diverged.is_simulated else " of the wall clock"
        at = f" at {diverged.at:.1f} s{clock}" if diverged.at is not None else ""
        fault = f" The fault acts at {diverged.fault:.1f} s." if diverged.fault is not None else ""
        yield f"First difference{at}: {diverged.what}.{fault}"


def _checks(result: MutantResult, *, everything: bool) -> Iterator[Section]:
    """Yield the checks that let a survivor through in its most informative test, nearest to fail first."""
    number, diverged = most_informative(result) or (0, None)
    outcome = result.rounds[number]
    if outcome is None or not result.is_survivor:
        return
    tests = [test for test in outcome.looked if test.acted]
    looked = next((test for test in tests if diverged is None or test.test == diverged.test), None)
    if looked is None or not looked.checks:
        return
    checks = sorted(looked.checks, key=lambda check: inf if check.spare is None else check.spare)
    shown = checks if everything else checks[:_CHECKS]
    lines = [f"{check.place}  {check.text}{f'  with {check.seen}' if check.seen else ''}" for check in shown]
    left = len(checks) - len(shown) + looked.more
    where = f" (round {number + 1}, {looked.test})" if diverged is None else ""
    more = [f"and {plural(left, 'more check')}"] if left else []
    yield Section(f"Checks that held after the fault{where}", lines=[*lines, *more])


def suggested_sections(result: MutantResult, found: Suggestion | None) -> Iterator[Section]:
    """Yield the section of a survivor's suggested check; nothing for other mutants."""
    if not next_step(result):
        return
    if found is not None and found.code:
        where = f"A check that would catch it, in {found.test}"
        more = "`mutabot suggest` prints it as a diff."
        yield Section(where, code=found.code, lines=[*found.notes, more])
        return
    yield Section("What to do", lines=[next_step(result, found)])
