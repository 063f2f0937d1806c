"""A campaign on the terminal: mutants by rounds, scores, survivors and what stands outside the score."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import datetime

from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from mutabot.model import LeftOut, Outcome, Verdict
from mutabot.report.terminal.console import (
    add_row,
    between,
    heading,
    legend,
    make_mutant_table,
    make_table,
    mark_of,
    marks_in,
    percent,
    plain,
    plural,
    short_place,
)
from mutabot.report.texts import OUTSIDE
from mutabot.results.divergence import first_line
from mutabot.results.results import MutantResult, Results
from mutabot.results.score import Group, RoundScores, Score
from mutabot.results.statistics import Interval

from .mutant import unlooked_lines
from .trust import budget_lines, control_lines, error_lines, since_lines, trust_lines

#: rounds from which on a row gives counts in place of one letter each
_MANY_ROUNDS = 12
#: columns from which on every fact of a mutant has a column of its own
WIDE = 110
#: columns from which on there is room for kill rates
RATES = 72
_INTERVALS = (
    "Intervals hold the true value in 95 % of campaigns: of a score over other rounds and mutants like "
    "these, of a kill rate over other rounds (docs/statistics.md)."
)


def print_results(console: Console, results: Results, *, everything: bool = False) -> None:
    """Print the whole report; ``everything`` also lists each mutant that the plan left out."""
    for part in _parts(results, console.width, everything):
        console.print(part)


def _parts(results: Results, width: int, everything: bool) -> Iterator[RenderableType]:
    yield Text(title(results), style="bold")
    yield Text(_circumstances(results), style="dim")
    yield from error_lines(results)
    yield from earlier_lines(results)
    if results.mutants:
        yield heading("Mutants by rounds")
        yield mutant_table(results, width)
        yield legend(outcome for result in results.mutants for outcome in result.rounds)
    if results.done:
        yield heading("Killed / valid mutants per round")
        yield from round_tables(results, width)
        yield heading("Scores")
        yield group_table(results)
        if results.rounds > 1:
            yield Text(_INTERVALS, style="dim")
        yield from sample_lines(results)
    yield from since_lines(results)
    yield from budget_lines(results)
    yield from survivor_lines(results, width)
    yield from unlooked_lines(results)
    yield from better_lines(results)
    yield from ladder_lines(results)
    yield from _outside(results, width)
    yield from left_out_lines(results.left_out, everything=everything)
    yield from trust_lines(results)
    yield from control_lines(results)


def title(results: Results) -> str:
    """How many mutants and rounds, and how the campaign ended."""
    kinds = [plural(len(results.mutants), "mutant")] if results.mutants or not results.ladders else []
    kinds += [plural(results.ladders, "ladder")] if results.ladders else []
    size = f"{' and '.join(kinds)} × {plural(results.rounds, 'round')}"
    if results.done == results.planned:
        return f"{size}: {results.state}"
    return f"{size}: {results.state}, {results.known}"


def _circumstances(results: Results) -> str:
    meta = results.meta
    parts = [f"{key} {meta[key]}" for key in ("mutabot", "engine", "seed") if meta.get(key) is not None]
    started = meta.get("started")
    if isinstance(started, int | float):
        parts.append(f"started {datetime.fromtimestamp(started).astimezone():%Y-%m-%d %H:%M}")
    tests = {one.test.test for one in results.baseline}
    if tests:
        parts.append(f"baseline of {plural(len(tests), 'test')}")
    return " · ".join(parts)


def earlier_lines(results: Results) -> Iterator[RenderableType]:
    """What the last campaign did not find itself, and a later one that ended before it ran anything."""
    if results.attempt == "running":
        yield Text("A new campaign runs its baseline; until it has a plan, this is the one before.")
    elif results.attempt is not None:
        text = (
            f"A later run ended before its first mutant ({plain(results.attempt)}); this is the one before."
        )
        yield Text(text, style="bold", overflow="fold")
    earlier = results.earlier
    if not earlier:
        return
    text = f"{len(earlier)} of {plural(len(results.mutants), 'mutant')} from earlier runs"
    outdated = sum(result.outdated for result in earlier)
    if outdated:
        what = "all" if outdated == len(earlier) else str(outdated)
        text += f"; {what} of them (*) from before something changed that they depend on"
    yield Text(f"{text}.", overflow="fold")


def mutant_table(results: Results, width: int) -> Table:
    """One row per mutant, one letter per round; on a narrow terminal a row has two lines."""
    narrow = width < WIDE
    table = make_mutant_table(("role", "place", "operator"), "what it does", narrow=narrow)
    many = results.rounds > _MANY_ROUNDS
    with_rates = results.rounds > 1 and width >= RATES
    if with_rates:
        table.add_column("killed", justify="right", no_wrap=True)
    table.add_column("rounds" if many else _round_numbers(results.rounds), no_wrap=not many)
    for result in results.mutants:
        mutant = result.mutant
        facts = (mutant.site.role.value, _place(result), mutant.operator)
        more = [_row(result.rounds, many)]
        if with_rates:
            more.insert(0, _kill_rate(result.kill_rate, narrow=narrow))
        number = f"{mutant.number}{'*' if result.outdated else ''}"
        add_row(table, number, facts, mutant.description, *more, narrow=narrow)
    return table


def _round_numbers(rounds: int) -> str:
    return " ".join(str(number)[-1] for number in range(1, rounds + 1)) or "–"


def _row(outcomes: Sequence[Outcome | None], many: bool) -> Text:
    if many:
        parts = [Text(f"{mark.letter}{count}", style=mark.style) for mark, count in marks_in(outcomes)]
    else:
        parts = [mark_of(outcome).text for outcome in outcomes]
    return Text(" ").join(parts)


def _kill_rate(rate: Score, *, narrow: bool) -> Text:
    """``3/5`` and its interval, on a line each where there is little room."""
    interval = between(rate.interval) if rate.interval is not None else ""
    # spaces that do not break are not cut off at the end of a cell either
    return Text.assemble(
        f"{rate.killed}/{rate.valid}",
        "\n" if narrow else " ",
        (interval if narrow else interval.rjust(8, "\N{NO-BREAK SPACE}"), "dim"),
    )


def _place(result: MutantResult) -> str:
    return short_place(result.mutant.site.span)


def round_tables(results: Results, width: int) -> Iterator[Table]:
    """Killed / valid per round for every group; several tables where one would be too wide."""
    at_once = max(3, (width - 36) // 8)
    for start in range(0, results.rounds, at_once):
        yield _round_table(results, range(start, min(start + at_once, results.rounds)))


def _round_table(results: Results, rounds: range) -> Table:
    table = make_table()
    table.add_column("round")
    for number in rounds:
        table.add_column(str(number + 1), justify="right", no_wrap=True)
    table.add_column("mean", justify="right", no_wrap=True)
    rows = [(group_name(group), group.scores) for group in results.groups]
    if len(rows) > 1:
        rows.append(("all together", results.all))
    for name, scores in rows:
        cells = [f"{scores.rounds[i].killed}/{scores.rounds[i].valid}" for i in rounds]
        shares = [_whole_percent(scores.rounds[i].score) for i in rounds]
        table.add_row(name, *cells, percent(scores.mean))
        table.add_row("", *(Text(share, style="dim") for share in shares), "")
    return table


def _whole_percent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.0f} %"


def group_name(group: Group) -> str:
    """``robot · program``."""
    return f"{group.family} · {group.role}"


def group_table(results: Results) -> Table:
    """Score, check score and counts per family and role."""
    table = make_table()
    table.add_column("family · role")
    for name in ("mutants", "score", "check score"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("outcomes over all rounds", overflow="fold")
    for group in results.groups:
        total = group.scores.total
        table.add_row(
            group_name(group),
            str(group.mutants),
            _score_cell(group.scores.mean, total.killed, total.valid, group.scores.interval),
            _score_cell(group.scores.mean_check, total.by_check, total.valid, group.scores.check_interval),
            _counts(group.scores),
        )
    return table


def sample_lines(results: Results) -> Iterator[RenderableType]:
    """How the mutants were drawn, and what that says about all of them."""
    drawing = results.drawing
    if drawing is None:
        return
    drawn = f"{sum(group.mutants for group in results.drawn)} of {plural(drawing.selected, 'mutant')}"
    yield heading(f"{drawn} were drawn: a sample of {drawing.sample}")
    for group in results.drawn:
        if group.population is not None:
            yield Text(_all_text(group), overflow="fold")


def _all_text(group: Group) -> str:
    drawn = f"{group_name(group)}: {group.mutants} of {group.population}"
    scores = group.scores
    if scores.sample_interval is None or scores.sample_check_interval is None:
        return f"{drawn}; too few to say anything about all of them"
    whole, check = between(scores.sample_interval), between(scores.sample_check_interval)
    return f"{drawn}; score of all of them in these rounds {whole}, check score {check}"


def _score_cell(mean: float | None, killed: int, valid: int, interval: Interval | None) -> Text:
    text = Text(f"{percent(mean)}\n{killed}/{valid}")
    return text if interval is None else text.append(f"\n{between(interval)}", style="dim")


def _counts(scores: RoundScores) -> str:
    total = scores.total
    by_exception = total.counts.get(Verdict.KILLED, 0) - total.by_check
    parts = [f"{total.by_check} killed by a check", f"{by_exception} by an exception"]
    others = (verdict for verdict in Verdict if verdict is not Verdict.KILLED)
    parts += [f"{total.counts[one]} {one}" for one in others if total.counts.get(one)]
    return ", ".join(parts)


def survivor_lines(results: Results, width: int, *, at_most: int | None = None) -> Iterator[RenderableType]:
    """The survivors, the farthest from the original first; of many, the first ``at_most``."""
    survivors = results.survivors
    if not survivors:
        if results.all.total.valid:
            yield heading("No survivors")
        return
    yield heading(f"{plural(len(survivors), 'survivor')}, the farthest from the original first")
    narrow = width < WIDE
    table = make_mutant_table(("place", "operator", "let through"), "why", narrow=narrow)
    for result in survivors[:at_most]:
        rate = result.kill_rate
        let_through = f"{rate.valid - rate.killed} of {rate.valid}"
        facts = (
            _place(result),
            result.mutant.operator,
            f"{let_through} rounds" if narrow else let_through,
        )
        add_row(table, result.mutant.number, facts, result.why, narrow=narrow)
    yield table
    if at_most is not None and len(survivors) > at_most:
        yield Text(f"and {len(survivors) - at_most} more", style="dim")


def better_lines(results: Results) -> Iterator[RenderableType]:
    """Survivors with which a test did better than without, by a figure of merit of the vocabulary."""
    found = [result for result in results.mutants if result.improvement]
    if found:
        yield heading(f"{plural(len(found), 'mutant')} better than the original")
        for result in found:
            text = (
                f"{result.mutant.number:>4}  {_place(result)} {result.mutant.operator}: {result.improvement}"
            )
            yield Text(plain(text), overflow="fold")


def ladder_lines(results: Results) -> Iterator[RenderableType]:
    """That there are ladders, which are in no score, and where to look."""
    if results.ladders:
        runs = sum(len(result.outcomes) for result in results.graded)
        text = f"{plural(results.ladders, 'ladder')} of graded mutants, {plural(runs, 'run')}, in no score"
        yield heading(f"{text}: `mutabot thresholds` shows them")


def _outside(results: Results, width: int) -> Iterator[RenderableType]:
    narrow = width < WIDE
    for verdict in OUTSIDE:
        found = results.with_verdict(verdict)
        if not found:
            continue
        yield heading(f"{plural(len(found), 'mutant')} outside the score: {verdict}")
        table = make_mutant_table(("place", "operator"), "reason", narrow=narrow)
        for result, outcome in found:
            facts = (_place(result), result.mutant.operator)
            add_row(table, result.mutant.number, facts, first_line(outcome.message), narrow=narrow)
        yield table


def left_out_lines(left_out: Sequence[LeftOut], *, everything: bool = False) -> Iterator[RenderableType]:
    """What the plan leaves out: how many and why, or each of them."""
    if not left_out:
        return
    hint = "" if everything else " (--all lists them)"
    yield heading(f"{plural(len(left_out), 'mutant')} left out, because they cannot matter{hint}")
    for reason, count in Counter(item.reason for item in left_out).most_common():
        yield Text(f"{count:>4}  {plain(reason)}", overflow="fold")
        if everything:
            for item in left_out:
                if item.reason == reason:
                    yield Padding(
                        Text(f"{item.id}  {plain(item.description)}", overflow="fold"), (0, 0, 0, 8)
                    )


#: survivors that are shown
_SURVIVORS = 10


def print_summary(console: Console, results: Results) -> None:
    """Print how a run ended."""
    for part in _summary_parts(results, console.width):
        console.print(part)


def _summary_parts(results: Results, width: int) -> Iterator[RenderableType]:
    yield Text(title(results), style="bold")
    yield from error_lines(results)
    if results.done:
        yield _score_table(results, with_interval=width >= RATES)
        yield from sample_lines(results)
    yield from since_lines(results)
    yield from budget_lines(results)
    yield from survivor_lines(results, width, at_most=_SURVIVORS)
    yield from unlooked_lines(results)
    yield from better_lines(results)
    yield from _counted(results)
    yield from ladder_lines(results)
    yield from trust_lines(results)
    yield Text("\n`mutabot results` shows every mutant, `mutabot show N` all about one.", style="dim")


def _score_table(results: Results, *, with_interval: bool) -> RenderableType:
    """A line for each family and role."""
    table = make_table()
    table.add_column("family · role", no_wrap=True)
    for name in ("score", "check score", "killed"):
        table.add_column(name, justify="right", no_wrap=True)
    for group in results.groups:
        total = group.scores.total
        killed = f"{total.killed} of {total.valid}"
        interval = group.scores.interval if with_interval else None
        score = percent(group.scores.mean) + (f" ({between(interval)})" if interval is not None else "")
        table.add_row(group_name(group), score, percent(group.scores.mean_check), killed)
    return table


def _counted(results: Results) -> Iterator[RenderableType]:
    counts: Counter[Verdict] = Counter()
    for verdict in OUTSIDE[1:]:  # errors have a place of their own
        counts[verdict] = len(results.with_verdict(verdict))
    told = [f"{count} {verdict.value}" for verdict, count in counts.items() if count]
    if told:
        yield heading(f"Mutants outside the score: {', '.join(told)}")
