"""A campaign on the terminal: the summary of a run, and the whole table of mutants."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import datetime

from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from mutabot.analysis.chance import Estimate, false_kills, false_survivors
from mutabot.analysis.divergence import first_line
from mutabot.analysis.results import MutantResult, Results, unlooked
from mutabot.analysis.score import Group
from mutabot.journal.records import REMARKS, Repeated
from mutabot.model import LeftOut, Outcome, Verdict
from mutabot.report.texts import OUTSIDE, why_alone

from .console import (
    below,
    between,
    heading,
    legend,
    make_table,
    mark_of,
    marks_in,
    note,
    percent,
    plain,
    plural,
    short_place,
)

#: rounds from which on a row gives counts in place of one letter each
_MANY_ROUNDS = 12
#: survivors that the summary shows, and numbers of mutants that a line gives
_SURVIVORS, _NUMBERS = 10, 10
_INTERVALS = "Intervals in parentheses: 95 % confidence over further rounds and mutants (docs/statistics.md)."
_NEXT = "`mutabot show N` prints the details of one; `mutabot suggest` searches for checks that kill them."
_DAMAGED = "The journal holds rows that are damaged or not of mutabot; they count as not run:"
_ALTERED = "Another program changed the journal during the campaign; mutabot restored its own rows:"


def print_results(console: Console, results: Results, *, everything: bool = False) -> None:
    """Print all mutants and the summary; ``everything`` also lists each mutant that the plan left out."""
    console.print(Text(title(results), style="bold"))
    console.print(Text(_circumstances(results), style="dim"))
    for part in (*_earlier(results), *_mutants(results), *_findings(results)):
        console.print(part)
    for verdict in OUTSIDE:
        for part in _outside(results, verdict):
            console.print(part)
    for part in (*left_out_lines(results.left_out, everything=everything), *_controls(results)):
        console.print(part)


def print_summary(console: Console, results: Results) -> None:
    """Print how a run ended: errors, scores, survivors, and what else matters."""
    console.print(Text(title(results), style="bold"))
    for part in _findings(results, at_most=_SURVIVORS):
        console.print(part)
    console.print(Text("Run `mutabot results` to list all mutants.", style="dim"))


def title(results: Results) -> str:
    """Return how many mutants and rounds there are, and how the campaign ended."""
    kinds = [plural(len(results.mutants), "mutant")] if results.mutants or not results.ladders else []
    kinds += [plural(results.ladders, "ladder")] if results.ladders else []
    text = f"{' and '.join(kinds)} × {plural(results.rounds, 'round')}: {results.state}"
    return text if results.done == results.planned else f"{text}, {results.known}"


def _circumstances(results: Results) -> str:
    meta = results.meta
    parts = [f"{key} {meta[key]}" for key in ("mutabot", "engine", "seed") if meta.get(key) is not None]
    started = meta.get("started")
    if isinstance(started, int | float):
        parts.append(f"started {datetime.fromtimestamp(started).astimezone():%Y-%m-%d %H:%M}")
    tests = {one.test.test for one in results.baseline}
    return " · ".join([*parts, *([plural(len(tests), "test")] if tests else [])])


def _earlier(results: Results) -> Iterator[RenderableType]:
    """What the last campaign did not find itself, and a later one that ended before it ran anything."""
    if results.attempt == "running":
        yield Text("A new campaign is still running its baseline; these are the previous results.")
    elif results.attempt is not None:
        ended = f"A later run ended before its first mutant ({plain(results.attempt)})"
        yield Text(f"{ended}; these are the previous results.", style="bold")
    if results.earlier:
        outdated = sum(result.outdated for result in results.earlier)
        known = f"{len(results.earlier)} of {plural(len(results.mutants), 'mutant')} from earlier runs"
        more = f"; {outdated} of them (*) are outdated: something they depend on has changed since"
        yield Text(f"{known}{more if outdated else ''}.")


def _mutants(results: Results) -> Iterator[RenderableType]:
    """One row per mutant, one letter per round."""
    if not results.mutants:
        return
    many = results.rounds > _MANY_ROUNDS
    numbers = " ".join(str(number)[-1] for number in range(1, results.rounds + 1)) or "–"
    table = make_table((">no.", "role", "place", "operator", "*fault", "*rounds" if many else numbers))
    for result in results.mutants:
        mutant = result.mutant
        table.add_row(
            f"{mutant.number}{'*' if result.outdated else ''}",
            mutant.site.role.value,
            short_place(mutant.site.span),
            mutant.operator,
            plain(mutant.description),
            letters(result.rounds, many=many),
        )
    yield table
    yield legend(outcome for result in results.mutants for outcome in result.rounds)


def letters(rounds: Sequence[Outcome | None], *, many: bool = False) -> Text:
    """Return one letter per round, or how often each occurs."""
    if many:
        parts = [Text(f"{mark.letter}{count}", style=mark.style) for mark, count in marks_in(rounds)]
    else:
        parts = [Text(mark_of(one).letter, style=mark_of(one).style) for one in rounds]
    return Text(" ").join(parts)


def _findings(results: Results, at_most: int | None = None) -> Iterator[RenderableType]:
    """What a run is for: errors, scores, survivors, and what is to be known of them."""
    yield from _errors(results)
    if results.done:
        yield _scores(results)
        if results.rounds > 1:
            yield Text(_INTERVALS, style="dim")
        yield from _sample(results)
    yield from _narrowed(results)
    yield from _survivors(results, at_most)
    found = [one.text for one in unlooked(results.mutants)]
    if found:
        yield from note("Readings that no test checks", found)
    better = [
        f"{_place(one)} {one.mutant.operator}: {one.improvement}"
        for one in results.mutants
        if one.improvement
    ]
    if better:
        yield from note(f"{plural(len(better), 'mutant')} did better than the original", better)
    counts = {verdict.value: len(results.with_verdict(verdict)) for verdict in OUTSIDE[1:]}
    told = [f"{count} {name}" for name, count in counts.items() if count]
    if told:
        yield heading(f"Not counted in the score: {', '.join(told)}")
    if results.ladders:
        runs = sum(len(result.outcomes) for result in results.graded)
        graded = f"{plural(results.ladders, 'ladder')} of graded mutants ({plural(runs, 'run')})"
        yield heading(f"{graded} count in no score: `mutabot thresholds` shows them")
    yield from _reliability(results)


def _errors(results: Results) -> Iterator[RenderableType]:
    """How many outcomes are errors, and one line per message with the mutants that it is about."""
    found: dict[str, list[int]] = {}
    for result in results.everything:
        for outcome in result.outcomes:
            if outcome.verdict is Verdict.ERROR:
                found.setdefault(first_line(outcome.message), []).append(result.mutant.number)
    if not found:
        return
    run = sum(len(result.outcomes) for result in results.everything)
    lines = [
        f"{len(those)} × {message} ({_numbered(those)})"
        for message, those in sorted(found.items(), key=lambda item: -len(item[1]))
    ]
    count = sum(map(len, found.values()))
    text = f"{count} of {plural(run, 'outcome')} ended in error, so nothing is known of them"
    yield from note(text, lines, "bold red")


def _numbered(numbers: Sequence[int]) -> str:
    different = list(dict.fromkeys(numbers))
    shown = ", ".join(map(str, different[:_NUMBERS]))
    more = f" and {len(different) - _NUMBERS} more" if len(different) > _NUMBERS else ""
    return f"mutant{'s' if len(different) > 1 else ''} {shown}{more}"


def _scores(results: Results) -> Table:
    """A row for each family and role. There is no combined score."""
    table = make_table(("family · role", ">mutants", ">score", ">check score", ">killed"))
    for group in results.groups:
        scores, total = group.scores, group.scores.total
        interval = f" ({between(scores.interval)})" if scores.interval is not None else ""
        killed = f"{total.killed} of {total.valid}"
        score = f"{percent(scores.mean)}{interval}"
        table.add_row(group_name(group), str(group.mutants), score, percent(scores.mean_check), killed)
    return table


def group_name(group: Group) -> str:
    """Return ``robot · program``."""
    return f"{group.family} · {group.role}"


def _sample(results: Results) -> Iterator[RenderableType]:
    """How the mutants were drawn, and what that says about all of them."""
    drawing = results.drawing
    if drawing is None:
        return
    drawn = sum(group.mutants for group in results.drawn)
    lines = []
    for group in results.drawn:
        scores = group.scores
        known = "too few to say anything about all of them"
        if scores.sample_interval is not None and scores.sample_check_interval is not None:
            known = (
                f"score of all of them in these rounds {between(scores.sample_interval)}, "
                f"check score {between(scores.sample_check_interval)}"
            )
        if group.population is not None:
            lines.append(f"{group_name(group)}: {group.mutants} of {group.population}; {known}")
    yield from note(f"Sample of {drawing.sample}: {drawn} of {plural(drawing.selected, 'mutant')}", lines)


def _narrowed(results: Results) -> Iterator[RenderableType]:
    """What ``--since`` and ``--budget`` left out."""
    since, budget = results.since, results.budget
    if since is not None:
        run, unjudged = sum(since.run.values()), sum(since.not_judged.values())
        lines = [f"{count} run: {why}" for why, count in since.run.items()]
        lines += [f"{count} not judged: {why}" for why, count in since.not_judged.items()]
        lines += ["Scores are of the mutants that were run or reused, not of all."] if unjudged else []
        reused = f"{run} run, {since.taken_over} reused{f', {unjudged} not judged' if unjudged else ''}"
        yield from note(f"Since {since.ref} ({since.commit[:7]}): {reused}", lines)
    if budget is not None and not budget.is_whole:
        done = f"{budget.run + budget.cut_off} of {budget.planned} runs done, most informative first"
        cut = f"{budget.cut_off} are from a batch that was cut off, in which kills end before survivors."
        lines = ["Scores are of the mutants that were run.", *([cut] if budget.cut_off else [])]
        yield from note(f"Time limit reached: {done}", lines)


def _place(result: MutantResult) -> str:
    return f"{result.mutant.number:>4}  {short_place(result.mutant.site.span)}"


def _survivors(results: Results, at_most: int | None) -> Iterator[RenderableType]:
    """Survivors with an effect, the largest first; those without one in a line."""
    survivors = results.survivors
    if not survivors:
        if results.all.total.valid:
            yield heading("No survivors")
        return
    same = [result.mutant.number for result in survivors if result.indistinguishable]
    shown = [result for result in survivors if not result.indistinguishable]
    order = ", largest deviation from the original first" if len(shown) > 1 else ""
    yield heading(f"{plural(len(survivors), 'survivor')}{order}")
    table = make_table((">no.", "place", "operator", "*fault and effect", ">survived"))
    for result in shown[:at_most]:
        rate, mutant = result.kill_rate, result.mutant
        text = Text.assemble(plain(mutant.description), "\n", (plain(why_alone(result)), "bold"))
        survived = f"{rate.valid - rate.killed} of {rate.valid}"
        table.add_row(str(mutant.number), short_place(mutant.site.span), mutant.operator, text, survived)
    if shown:
        yield table
    if at_most is not None and len(shown) > at_most:
        yield Text(f"and {len(shown) - at_most} more", style="dim")
    if same:
        number = "1 has" if len(same) == 1 else f"{len(same)} have"
        yield Text(f"{number} no measured effect on what the robot did: {_numbered(same)}", overflow="fold")
    yield Text(_NEXT, style="dim")


def _outside(results: Results, verdict: Verdict) -> Iterator[RenderableType]:
    found = results.with_verdict(verdict)
    if found:
        yield heading(f"{plural(len(found), 'mutant')} outside the score: {verdict}")
        table = make_table((">no.", "place", "operator", "*reason"))
        for result, outcome in found:
            mutant, reason = result.mutant, plain(first_line(outcome.message))
            table.add_row(str(mutant.number), short_place(mutant.site.span), mutant.operator, reason)
        yield table


def left_out_lines(left_out: Sequence[LeftOut], *, everything: bool = False) -> Iterator[RenderableType]:
    """Yield how many mutants the plan skips and why, or each of them."""
    if not left_out:
        return
    hint = "" if everything else " (use --all to list them)"
    skipped = f"{plural(len(left_out), 'mutant')} skipped because they would not change anything"
    yield heading(f"{skipped}{hint}")
    for reason, count in Counter(item.reason for item in left_out).most_common():
        yield Text(f"{count:>4}  {plain(reason)}", overflow="fold")
        those = [item for item in left_out if item.reason == reason] if everything else []
        yield from (below(f"{item.id}  {item.description}", 8) for item in those)


def _reliability(results: Results) -> Iterator[RenderableType]:
    """Tests that were excluded, damage to the journal, and outcomes that were run again."""
    flaky = results.flaky.tests
    if flaky:
        yield from note(f"{plural(len(flaky), 'unreliable test')} excluded", flaky)
    for text, rows in ((_DAMAGED, results.set_aside), (_ALTERED, results.altered)):
        if rows:
            yield from note(text, rows, "bold red")
    for remark in results.meta.get(REMARKS) or ():
        yield from note(remark)
    confirmed, checked = results.confirmation, results.verification
    if confirmed is not None:
        yield from note(f"{confirmed.text}.", style="bold red" if confirmed.wrong else "bold")
    if checked is not None:
        lines = [
            f"mutant {one.number}, round {one.round + 1}: {one.first}; re-run: {one.second}"
            for one in checked.disagreements
        ]
        text = f"Verified: {checked.agreed} of {checked.checked} outcomes end the same in fresh processes."
        yield from note(text, lines, "bold red" if lines else "dim")
    repeats = results.repeats
    kinds = (("kill that might be a coincidence", repeats.doubted), ("other kill", repeats.others))
    yield from _re_runs("kills", false_kills(repeats), kinds)
    yield from _re_runs("survivors", false_survivors(repeats), (("survivor", repeats.survivors),))


def _re_runs(
    what: str, found: Estimate | None, kinds: Sequence[tuple[str, Repeated]]
) -> Iterator[RenderableType]:
    """How many outcomes were re-run, and how many of the others may be wrong; nothing if none was."""
    parts = []
    for name, one in kinds:
        several = name.replace("kill", "kills").replace("survivor", "survivors")
        if one.repeated:
            changed = (
                f"{one.changed} gave a different result and {'was' if one.changed == 1 else 'were'} dropped"
            )
            parts.append(f"{one.repeated} of {plural(one.outcomes, name, several)} re-run: {changed}")
        elif one.outcomes and name.startswith("other") and parts:
            parts.append(f"{plural(one.outcomes, name, several)} not re-run (--verify N re-runs some)")
    if parts and found is not None:
        interval = f"(95 % interval {found.low}–{found.high})"
        parts.append(f"estimated wrong {what} among {found.known}: {found.expected:.1f} {interval}")
    if parts:
        is_wrong = any(one.changed for _, one in kinds)
        yield from note(f"{what.capitalize()}: {'; '.join(parts)}.", style="bold red" if is_wrong else "dim")


def _controls(results: Results) -> Iterator[RenderableType]:
    """Whether the self-check passed."""
    wrong = [control for control in results.controls if not control.ok]
    for one in wrong:
        yield from note(
            f"The {one.control} control of {one.test_file} failed: {one.detail}", style="bold red"
        )
    if results.controls and not wrong:
        files = {control.test_file.partition("::")[0] for control in results.controls}
        where = plural(len(files), "test file")
        text = f"Self-check passed in {where} (a no-op mutant survived, a crashing one was killed)."
        yield from note(text, style="dim")
