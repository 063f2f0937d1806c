"""The sections of a campaign's report, as plain rows and lines, for the terminal and Markdown."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from mutabot.errors import in_short, plural
from mutabot.frozen import frozen
from mutabot.journal.records import RAN_OVER, REMARKS, SIMULATION, Repeated, Untested
from mutabot.model import LeftOut, Mutant, Span, Verdict
from mutabot.model.left_out import NOTHING, by_heading
from mutabot.model.outcome_text import first_line
from mutabot.results.divergence import UNKNOWN_END
from mutabot.results.results import OUTSIDE, Results, unlooked
from mutabot.results.score import percent
from mutabot.results.statistics import Estimate, Interval, false_kills, false_survivors
from mutabot.thresholds.thresholds import ladder_line, thresholds_of

from .texts import acceptance_text, effect_text, escaped, places_text, rounds_text

if TYPE_CHECKING:
    from mutabot.results.score import Group

PlaceName = Callable[[Span], str]
#: numbers of mutants that a line gives
_NUMBERS = 10
_INTERVALS = "In parentheses: 95 % confidence intervals over further rounds and mutants (docs/statistics.md)."
_DAMAGED = "The journal holds rows that are damaged or not of mutabot; they count as not run"
_ALTERED = "Another program changed the journal during the campaign; mutabot restored its own rows"


@frozen
class Section:
    """A section.

    Attributes:
        title: what it says in a line.
        columns: of its table; ``>name`` holds numbers, ``*name`` longer texts.
        rows: of its table.
        lines: what stands below the table.
        is_alarm: whether results cannot be relied on without knowing it.
        is_detail: whether the summary of a run shows the title of its table alone, and nothing without one.
        code: statements above the lines, which are never wrapped.
    """

    title: str
    columns: tuple[str, ...] = ()
    rows: Sequence[tuple[str, ...]] = ()
    lines: Sequence[str] = ()
    is_alarm: bool = False
    is_detail: bool = False
    code: str = ""


def sections(results: Results, place: PlaceName) -> Iterator[Section]:
    """Yield the sections that are not empty. ``place`` names a span for the reader."""
    yield from _errors(results)
    if results.done:
        yield from _scores(results)
    yield from untested(results.untested)
    yield from _narrowed(results)
    yield from _survivors(results, place)
    yield from accepted_sections(results, place)
    if found := unlooked(results.mutants):
        yield Section("Readings whose faults no test noticed", lines=found)
    yield from _outside(results, place)
    yield from skipped(results.left_out)
    yield from _thresholds(results, place)
    yield from _reliability(results)


#: columns that say which mutant a row is about
MUTANT_COLUMNS = (">no.", "place", "operator", "*fault")


def mutant_cells(mutant: Mutant, place: PlaceName) -> tuple[str, ...]:
    """Return the cells of these columns."""
    return str(mutant.number), places_text(mutant.site, place), mutant.operator, mutant.description


def _errors(results: Results) -> Iterator[Section]:
    """Yield how many outcomes are errors, and one line per message with the mutants that it is about."""
    found: dict[str, list[int]] = {}
    for result in results.everything:
        for outcome in result.outcomes:
            if outcome.verdict is Verdict.ERROR:
                found.setdefault(first_line(outcome.message), []).append(result.mutant.number)
    count, run = sum(map(len, found.values())), sum(len(result.outcomes) for result in results.everything)
    if count:
        ranked = sorted(found.items(), key=lambda item: -len(item[1]))
        lines = [f"{len(those)} × {message} ({numbered(those)})" for message, those in ranked]
        title = f"{count} of {plural(run, 'outcome')} ended in error, so nothing is known of them"
        yield Section(title, lines=lines, is_alarm=True)


def _scores(results: Results) -> Iterator[Section]:
    """Yield a row for each family and role. There is no combined score."""
    columns: tuple[str, ...] = ("family · role", ">mutants", ">score", ">check score", ">killed")
    rows = [_score_row(group) for group in results.groups]
    if results.accepted:
        columns = (*columns, ">accepted")
        rows = [(*row, str(group.scores.accepted)) for row, group in zip(rows, results.groups, strict=True)]
    if rows:
        lines = [_INTERVALS] if any(group.scores.interval for group in results.groups) else []
        yield Section("Scores", columns, rows, [*lines, *results.bugs_caught])
    if results.drawing is not None:
        drawn = sum(group.mutants for group in results.drawn)
        size = results.drawing.sample
        each = "" if size.endswith("%") else " of each family"
        title = f"Sample of {size}{each}: {drawn} of {plural(results.drawing.selected, 'mutant')}"
        lines = [_sample_line(group) for group in results.drawn if group.population is not None]
        yield Section(title, lines=lines)


def _score_row(group: Group) -> tuple[str, ...]:
    scores, total = group.scores, group.scores.total
    interval = f" ({between(scores.interval)})" if scores.interval is not None else ""
    score, check = f"{percent(scores.mean)}{interval}", percent(scores.mean_check)
    killed = f"{total.killed} of {total.valid}"
    return f"{group.family} · {group.role}", str(group.mutants), score, check, killed


def _sample_line(group: Group) -> str:
    drawn = f"{group.family} · {group.role}: {group.mutants} of {group.population}"
    whole, check = group.scores.sample_interval, group.scores.sample_check_interval
    if whole is None or check is None:
        return f"{drawn}; too few to say anything about all of them"
    return f"{drawn}; score of all of them in these rounds {between(whole)}, check score {between(check)}"


def _narrowed(results: Results) -> Iterator[Section]:
    """Yield the mutants that ``--since`` and ``--budget`` left out."""
    since, budget = results.since, results.budget
    if since is not None:
        run, unjudged = sum(since.run.values()), sum(since.not_judged.values())
        lines = [f"{count} run: {why}" for why, count in since.run.items()]
        lines += [f"{count} not judged: {why}" for why, count in since.not_judged.items()]
        lines += ["Scores are of the mutants that were run or reused, not of all."] if unjudged else []
        reused = f"{run} run, {since.taken_over} reused{f', {unjudged} not judged' if unjudged else ''}"
        yield Section(f"Since {since.ref} ({since.commit[:7]}): {reused}", lines=lines)
    if budget is not None and not budget.is_whole:
        done = f"{budget.run + budget.cut_off} of {budget.planned} runs done, most informative first"
        cut = f"{budget.cut_off} are from a batch that was cut off, in which kills end before survivors."
        lines = ["Scores are of the mutants that were run.", *([cut] if budget.cut_off else [])]
        yield Section(f"Time limit reached: {done}", lines=lines)


#: names that a line gives of what no test reaches
_NAMES = 5


def untested(found: Untested, *, everything: bool = False) -> Iterator[Section]:
    """Yield what no test reaches of the program; with ``everything``, a line for each name."""
    lines = []
    for what, names in found.named.items():
        if everything:
            lines += [f"{what}:", *(f"  {name}" for name in names)]
        else:
            lines.append(f"{what}: {in_short(names, _NAMES)}")
    if lines:
        yield Section(found.text or "Calls that no test reaches may be robot calls", lines=lines)


#: number of survivors that are described although none had a measured effect
_FEW = 10


def _survivors(results: Results, place: PlaceName) -> Iterator[Section]:
    """Yield survivors with an effect, the largest first, and a line with those without an effect."""
    idle = [survivor for survivor in results.survivors if survivor.status is Verdict.NOT_COVERED]
    for is_killed, where in ((False, ""), (True, " in some round; killed in the others")):
        found = [each.mutant.number for each in idle if bool(each.kill_rate.killed) is is_killed]
        if found:
            text = f"{plural(len(found), 'mutant')} not covered, since no test reaches the place{where}"
            yield Section(text, lines=[numbered(found)])
    survivors = [survivor for survivor in results.survivors if survivor.status is not Verdict.NOT_COVERED]
    if not survivors:
        if results.all.total.valid > len(idle) * results.rounds:
            yield Section("No survivors" if results.is_complete else "No survivors so far")
        return
    same = sorted(result.mutant.number for result in survivors if result.indistinguishable)
    shown = [result for result in survivors if not result.indistinguishable]
    is_ranked = len(shown) > 1 and shown[0].deviation > 0.0
    order = ", largest deviation from the original first" if is_ranked else ""
    if not shown and len(same) <= _FEW:  # else nothing would say which faults these are
        shown, same = survivors, []
    effects = [effect_text(result) for result in shown]
    unknown = sum(UNKNOWN_END in effect for effect in effects) > 1  # then it is said once
    rows = [
        (
            *mutant_cells(result.mutant, place),
            effect.replace(UNKNOWN_END, "").removesuffix("; ") if unknown else effect,
            f"{len(result.survived)} of {result.kill_rate.valid}",
        )
        for result, effect in zip(shown, effects, strict=True)
    ]
    columns = (*MUTANT_COLUMNS, "*effect", ">survived") if rows else ()
    lines = [f"{plural(len(same), 'survivor')} without a measured effect: {numbered(same)}"] if same else []
    lines += [f"Where no effect is listed, {UNKNOWN_END}."] if unknown else []
    yield Section(f"{plural(len(survivors), 'survivor')}{order}", columns, rows, lines)


def accepted_sections(results: Results, place: PlaceName) -> Iterator[Section]:
    """Yield accepted survivors with the reasons, and decisions that no longer have an effect."""
    rows = [(*mutant_cells(result.mutant, place), acceptance_text(result)) for result in results.accepted]
    if rows:
        title = f"{plural(len(rows), 'survivor')} accepted, in no score"
        yield Section(title, (*MUTANT_COLUMNS, "*reason"), rows, is_detail=True)
    if lines := [*results.needlessly_accepted, *results.accepting.unmatched]:
        yield Section("Accepted or excluded without an effect", lines=lines)


def _outside(results: Results, place: PlaceName) -> Iterator[Section]:
    """Yield mutants with rounds that do not count, with the reason of the first such round."""
    found = [(verdict, results.with_verdict(verdict)) for verdict in OUTSIDE]
    counts = ", ".join(f"{len(those)} {verdict}" for verdict, those in found if those)
    rows = [
        (*mutant_cells(result.mutant, place), f"{rounds_text(result)}: {first_line(outcome.message)}")
        for _, those in found
        for result, outcome in those
    ]
    if rows:
        columns = (*MUTANT_COLUMNS, "*result")
        yield Section(f"Not counted in the score: {counts}", columns, rows, is_detail=True)
    waiting = sum(not result.outcomes for result in results.mutants)
    if waiting:
        yield Section(f"{plural(waiting, 'mutant')} not run yet")


def skipped(left_out: Sequence[LeftOut], *, are_listed: bool = False) -> Iterator[Section]:
    """Yield the mutants that the plan leaves out, a line for each kind of reason."""
    found = by_heading(left_out)
    for number, (heading, those) in enumerate(found.items(), start=1):
        joined = " that " if heading == NOTHING else ": "
        is_last = number == len(found) and not are_listed
        lines = ["`mutabot list --all` lists each, with its reason."] if is_last else []
        title = f"{plural(len(those), 'mutant')} left out{joined}{heading}"
        yield Section(title, lines=lines, is_detail=True)


def _thresholds(results: Results, place: PlaceName) -> Iterator[Section]:
    """Yield the ladders of graded mutants, which are in no score."""
    if results.ladders:
        runs = sum(len(result.outcomes) for result in results.graded)
        graded = f"{plural(results.ladders, 'ladder')} of graded mutants ({plural(runs, 'run')})"
        rows = [
            (places_text(ladder.mutant.site, place), ladder.name, ladder_line(ladder))
            for ladder in thresholds_of(results).ladders
        ]
        title = f"{graded}, in no score: `mutabot thresholds` shows them"
        columns = ("place", "*fault", "*noticed")
        yield Section(title, columns, rows, is_detail=True)


def _reliability(results: Results) -> Iterator[Section]:
    """Yield excluded tests, damage to the journal, re-run outcomes, and the results of ``--verify``."""
    flaky, confirmed, checked = results.flaky.tests, results.confirmation, results.verification
    if flaky:
        yield Section(f"{plural(len(flaky), 'unreliable test')} excluded", lines=flaky)
    for text, rows in ((_DAMAGED, results.set_aside), (_ALTERED, results.altered)):
        if rows:
            yield Section(text, lines=rows, is_alarm=True)
    remarks = [*filter(None, [results.meta.get(RAN_OVER)]), *(results.meta.get(REMARKS) or ())]
    yield from (Section(str(remark)) for remark in remarks)
    if confirmed is not None:
        yield Section(f"{confirmed.text}.", is_alarm=bool(confirmed.wrong))
    if checked is not None:
        where = "over the real middleware" if results.meta.get(SIMULATION) else "in fresh processes"
        lines = [
            f"mutant {pair.number}, round {pair.round + 1}: {pair.first}; re-run: {pair.second}"
            for pair in checked.disagreements
        ]
        text = f"Verified: {checked.agreed} of {checked.checked} outcomes end the same {where}."
        yield Section(text, lines=lines, is_alarm=bool(lines))
    repeats = results.repeats
    kinds = (("kill that might be a coincidence", repeats.doubted), ("other kill", repeats.others))
    yield from _re_runs("kills", false_kills(repeats), kinds)
    yield from _re_runs("survivors", false_survivors(repeats), (("survivor", repeats.survivors),))
    wrong = [
        f"{control.control} in {control.test_file}: {control.detail}"
        for control in results.controls
        if not control.ok
    ]
    if wrong:
        yield Section("Self-check failed", lines=wrong, is_alarm=True)
    elif results.controls:
        files = plural(
            len({control.test_file.partition("::")[0] for control in results.controls}), "test file"
        )
        text = f"Self-check passed in {files} (a no-op mutant survived, a crashing one was killed)"
        yield Section(text, is_detail=True)


def _re_runs(what: str, found: Estimate | None, kinds: Sequence[tuple[str, Repeated]]) -> Iterator[Section]:
    """Yield how many outcomes were re-run, and how many of the others may be wrong, if any were re-run."""
    parts = []
    for name, repeat in kinds:
        of_kind = plural(
            repeat.outcomes, name, name.replace("kill", "kills").replace("survivor", "survivors")
        )
        if repeat.repeated:
            were = "was" if repeat.changed == 1 else "were"
            dropped = f"{repeat.changed} gave a different result and {were} dropped"
            ended = dropped if repeat.changed else "with the same result"
            parts.append(f"{repeat.repeated} of {of_kind} re-run, {ended}")
        elif parts and repeat.outcomes:
            parts.append(f"{of_kind} not re-run (--verify N re-runs some)")
    if parts and found is not None and found.high:  # else all of which it speaks were re-run
        interval = f"(95 % interval {found.low}–{found.high})"
        parts.append(f"estimated wrong {what} among {found.known}: {found.expected:.1f} {interval}")
    if parts:
        text = f"{what.capitalize()}: {'; '.join(parts)}"
        yield Section(text, is_alarm=any(kind.changed for _, kind in kinds))


def section_lines(section: Section, at_most: int) -> Iterator[str]:
    """Yield the Markdown of a section, with at most ``at_most`` rows."""
    yield from (f"### {escaped(section.title)}", "")
    if section.columns:
        yield _row(name.lstrip(">*") for name in section.columns)
        yield _row("---:" if name.startswith(">") else "---" for name in section.columns)
        yield from (_row(map(escaped, row)) for row in section.rows[:at_most])
        yield ""
        if len(section.rows) > at_most:
            yield from (f"and {len(section.rows) - at_most} more, which the command line prints.", "")
    if section.lines:
        yield from (*(f"- {escaped(line)}" for line in section.lines), "")


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def numbered(numbers: Sequence[int]) -> str:
    """Return ``mutants 1, 2 and 9 more``."""
    different = [str(number) for number in dict.fromkeys(numbers)]
    return f"mutant{'s' if len(different) > 1 else ''} {in_short(different, _NUMBERS)}"


def size_text(results: Results) -> str:
    """Return ``24 mutants and 3 ladders × 5 rounds``; of a selection, ``24 of 70 mutants × 5 rounds``."""
    count, of = len(results.mutants), results.selected_of
    text = plural(count, "mutant") if of is None else f"{count} of {plural(of, 'mutant')}"
    kinds = [text] if results.mutants or not results.ladders else []
    kinds += [plural(results.ladders, "ladder")] if results.ladders else []
    return f"{' and '.join(kinds)} × {plural(results.rounds, 'round')}"


def between(interval: Interval | None) -> str:
    """Return an interval as text: ``34–90 %``, or ``–`` if there is none."""
    return "–" if interval is None else f"{100 * interval.low:.0f}–{100 * interval.high:.0f} %"
