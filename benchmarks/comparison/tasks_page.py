"""The text of docs/tasks.md: its sentences follow from what ``benchmarks/tasks.py`` has kept of campaigns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from statistics import fmean
from typing import Any

from mutabot.results.statistics import wilson

from .across import (
    STRENGTHS,
    alone,
    by_operator,
    cells,
    is_ordered,
    mean_over_tasks,
    operator_scores,
    rank_correlation,
    scores,
)
from .claims import CONVENTIONAL, Stance, decide, difference, difference_text, percent, share_text

Task = Mapping[str, Any]
#: the order of the page; other names follow by alphabet
ORDER = (
    "paper",
    "pick_and_place",
    "tracking",
    "palletising",
    "dispensing",
    "handover",
    "assembly",
    "bin_picking",
)
#: the families held against each other
ROBOT, TEXT = "robot", CONVENTIONAL[0]
#: the parts of the published claim: key of a share, its name on the page, and what it is
PARTS = (
    ("broken", "stillborn", "invalid, or an exception before any command reaches the robot"),
    ("impossible", "refused", "the robot refuses what is asked"),
    ("no_difference", "equivalent", "nothing that was compared differs, or no value changed"),
    ("any", "any of the three", "of no use for one of these reasons"),
    (
        "redundant",
        "redundant",
        "killed, and another mutant dies in the same tests and rounds, with equal messages",
    ),
)
#: operators need so many mutants in a task for a score, and so many in all tasks for a row
LEAST, LEAST_IN_ALL = 2, 4
#: operators that two tasks must have in common for a row of their own
FEWEST = 5

HEAD = """\
# Do operators and suites behave alike on other tasks?

<!-- Written by benchmarks/tasks.py from docs/data/tasks/*.json. Do not edit. -->

The study "Mutation Testing for Industrial Robotic Systems" names this threat: its operators are "specifically
tailored for a pick-and-place task". Here the same operators run on examples of other kinds of tasks, and on
recipes (plc, toolbox, ur and the like): programs that drive robot libraries and simulators of others.
`python benchmarks/tasks.py run NAME` runs the mutants of a program against every test that reaches them;
`python benchmarks/tasks.py` writes this page. Intervals have a level of 95 %.
"""
OF_NUMBERS = """\
Numbers are those of the day of the run, without the readings of the tests' own checks, which `mutabot list`
counts as well. Operators have changed since: of palletising, `mutabot list --family robot --only program` now
has 165 mutants, without those of parts of readings that nothing reads.\
"""
OF_CLAIMS = """\
Shares of outcomes (*redundant*: of killed mutants), and their difference in percentage points. It speaks
*for* the claim if its interval lies wholly above zero, *against* it if wholly below. The last row is the
mean of the tasks' differences; its interval is over tasks like these.
"""
OF_SUITES = """\
A suite holds the weaker ones, so it never kills less. The last column has the outcomes that only the strong
suite notices. Left out is what the robot refuses, what has no effect, and a few outcomes of which it is not
known which suite notices first, since the process did not come to the end of a test.
"""
OF_OPERATORS = f"""\
All tasks with three suites together, and operators with at least {LEAST_IN_ALL} mutants that count. *Told
apart* is what a stronger suite notices and the weak one does not (Wilson's interval over mutants, rounds
taken together).
"""
OF_RANKS = f"""\
Spearman's rank correlation of the operators' scores (all tests) between two tasks, over the operators with at
least {LEAST} mutants that count in both; the interval after Fieller. Pairs with fewer than {FEWEST} operators
count in the mean only: their correlations may be chance.
"""
TAIL = """\
## What this does not say

- Except the published program, all programs and suites were written for this project, also where they drive
  robot libraries and simulators of others (the recipes): others may differ more.
- Tasks that are not in the table of what was run say nothing.
- Tasks with one suite say nothing of weaker ones.
- *Equivalent* is what no comparison tells apart, which is no proof. What would change nothing in the baseline
  was left out beforehand.
- Mutants of what the tests read themselves (the oracle), of messages, and graded ones were not run.
- Rounds of one mutant mostly agree, and tasks are few: hence the wide intervals.
"""


def page(tasks: Mapping[str, Task]) -> str:
    """The whole page, by name of the task."""
    parts = [HEAD, *_in_short(tasks), *_campaigns(tasks), *_claims(tasks), *_suites(tasks)]
    return "\n".join([*parts, *_operators(tasks), *_between(tasks), TAIL])


def mutants_of(task: Task, family: str | None = None) -> list[Mapping[str, Any]]:
    """The mutants of a task, of one family or of all."""
    campaigns = [campaign for name, campaign in task["campaigns"].items() if family in (None, name)]
    return [mutant for campaign in campaigns for mutant in campaign["mutants"]]


def share_of(task: Task, family: str, key: str) -> Mapping[str, Any] | None:
    """A share of a family's outcomes (of its killed mutants, if redundant); None if there is nothing."""
    own = task["campaigns"].get(family, {}).get("families")
    if own is None or not own["done"]:
        return None
    if key != "redundant":
        found: Mapping[str, Any] = own["weaknesses"][key]
        return found
    count, of = own["redundant"], own["killed_mutants"]
    interval = wilson(count, of)
    if interval is None:
        return None
    ends = {"low": interval.low, "high": interval.high}
    return {"count": count, "of": of, "unknown": 0, "share": count / of, "interval": ends}


def with_suites(tasks: Mapping[str, Task]) -> dict[str, Task]:
    """The tasks whose tests are suites of three strengths."""
    return {
        name: task
        for name, task in tasks.items()
        if any(noticed == "strong" for mutant in mutants_of(task) for noticed in mutant["noticed"])
    }


def _in_short(tasks: Mapping[str, Task]) -> Iterator[str]:
    yield "## In short\n"
    for key, name, _ in PARTS:
        by_stance: dict[Stance, list[str]] = {kind: [] for kind in Stance}
        for task_name, task in tasks.items():
            if (stance := _stance(task, key)) is not None:
                by_stance[stance].append(task_name)
        more, less = (", ".join(by_stance[kind]) or "no task" for kind in (Stance.FOR, Stance.AGAINST))
        yield (
            f"- Conventional mutants are *{name}* more often than robot ones in {more},\n"
            f"  less often in {less}; undecided in the other {len(by_stance[Stance.UNDECIDED])}."
        )
    if suites := with_suites(tasks):
        ordered = [name for name, task in suites.items() if is_ordered(mutants_of(task, ROBOT))]
        names = f" ({', '.join(ordered)})" if ordered else ""
        yield (
            "- The strong suite kills more robot mutants than the medium one, and that more than the weak"
            f"\n  one, in every round, in {len(ordered)} of {len(suites)} tasks{names}."
        )
    if any(found is not None and found[1] is not None for _, _, found in _correlations(tasks, ROBOT)):
        yield (
            "- The rank correlation of the robot operators' scores between two tasks is on average "
            f"{_mean_correlation(tasks, ROBOT)}\n  (1: the same order, 0: no relation)."
        )
    yield ""


def _stance(task: Task, key: str) -> Stance | None:
    text, robot = share_of(task, TEXT, key), share_of(task, ROBOT, key)
    return decide(text, robot) if text is not None and robot is not None else None


def _campaigns(tasks: Mapping[str, Task]) -> Iterator[str]:
    yield "## What was run\n"
    yield "| task | rounds, seed | robot mutants | conventional mutants | processor time of their tests |"
    yield "|---|---:|---:|---:|---:|"
    for name, task in tasks.items():
        meta = next(iter(task["campaigns"].values()))["meta"]
        counts = [_drawn(task["campaigns"].get(family)) for family in (ROBOT, TEXT)]
        cpu = sum(campaign["families"]["cost"]["cpu"] for campaign in task["campaigns"].values())
        yield f"| {name} | {meta['rounds']}, {meta['seed']} | {' | '.join(counts)} | {cpu:.0f} s |"
    yield f"\n{OF_NUMBERS}"
    missing = [name for name in ORDER if name not in tasks]
    yield f"\nNot run: {', '.join(missing)}.\n" if missing else ""


def _drawn(campaign: Mapping[str, Any] | None) -> str:
    if campaign is None:
        return "not run"
    own = campaign["families"]
    return (
        f"{own['mutants']} of {own['population']}, drawn at random"
        if own["population"] not in (None, 0, own["mutants"])
        else f"all {own['mutants']}"
    )


def _claims(tasks: Mapping[str, Task]) -> Iterator[str]:
    yield "## Are conventional mutants of less use?\n"
    yield OF_CLAIMS
    for key, name, meaning in PARTS:
        yield f"### {name[0].upper()}{name[1:]}\n"
        yield f"{meaning[0].upper()}{meaning[1:]}.\n"
        yield "| task | conventional | robot | difference | the claim |"
        yield "|---|---:|---:|---:|---|"
        middles = []
        for task_name, task in tasks.items():
            text, robot = share_of(task, TEXT, key), share_of(task, ROBOT, key)
            if text is None or robot is None:
                continue
            found = difference(text, robot)
            middles += [found[0]] if found is not None else []
            yield (
                f"| {task_name} | {share_text(text)} | {share_text(robot)} | {difference_text(text, robot)} "
                f"| {decide(text, robot).value} |"
            )
        yield from _mean_row(middles)
        yield ""


def _mean_row(middles: Sequence[float]) -> Iterator[str]:
    found = mean_over_tasks(middles)
    if found is None:
        return
    middle, low, high = (f"{100 * value:+.1f}".replace("-", "−") for value in found)
    stance = Stance.FOR if found[1] > 0 else Stance.AGAINST if found[2] < 0 else Stance.UNDECIDED
    yield f"| mean of {len(middles)} | | | {middle} ({low} to {high}) | {stance.value} |"


def _suites(tasks: Mapping[str, Task]) -> Iterator[str]:
    if not with_suites(tasks):
        return
    yield "## Do stronger suites kill more?\n"
    yield OF_SUITES
    yield "| task, mutants | round | weak | medium | strong | the strong one alone |"
    yield "|---|---:|---:|---:|---:|---:|"
    for name, task in with_suites(tasks).items():
        for family in (ROBOT, TEXT):
            those = mutants_of(task, family)
            if not those:
                continue
            rows = zip(*(scores(those, strength) for strength in STRENGTHS), strict=True)
            for number, row in enumerate(rows, 1):
                told = " | ".join(f"{killed}/{valid}, {percent(killed / valid)}" for killed, valid in row)
                count, of, between = alone(those, "strong")
                last = f"{count}/{of}" + (
                    f" ({100 * between.low:.0f}–{100 * between.high:.0f} %)" if between else ""
                )
                yield f"| {name}, {family} | {number} | {told} | {last if number == 1 else ''} |"
    yield ""


def _operators(tasks: Mapping[str, Task]) -> Iterator[str]:
    if not with_suites(tasks):
        return
    yield "## Which operators tell suites apart?\n"
    yield OF_OPERATORS
    yield "| operator | mutants | weak | only medium | only strong | none | told apart |"
    yield "|---|---:|---:|---:|---:|---:|---:|"
    every = [mutant for task in with_suites(tasks).values() for mutant in mutants_of(task)]
    rows = []
    for operator, those in by_operator(every).items():
        parts = [_mean(those, [strength]) for strength in STRENGTHS]
        counted = sum(any(cell is not None for cell in row) for row in cells(those, ()))
        if counted >= LEAST_IN_ALL:
            apart = parts[1] + parts[2]
            rows.append((-apart, operator, counted, parts))
    for apart, operator, counted, parts in sorted(rows):
        between = wilson(-apart * counted, counted)
        shares = " | ".join(percent(part) for part in [*parts, max(0.0, 1 - sum(parts))])
        last = f"{percent(-apart)} ({100 * between.low:.0f}–{100 * between.high:.0f})" if between else "–"
        yield f"| {operator} | {counted} | {shares} | {last} |"
    yield ""


def _mean(those: Sequence[Mapping[str, Any]], strengths: Sequence[str]) -> float:
    """Share of the counting outcomes, of each mutant alike."""
    rows = [[cell for cell in row if cell is not None] for row in cells(those, strengths)]
    known = [fmean(row) for row in rows if row]
    return fmean(known) if known else 0.0


def _between(tasks: Mapping[str, Task]) -> Iterator[str]:
    if len(tasks) < 2:
        return
    yield "## Does one task foretell another?\n"
    yield OF_RANKS
    yield "| tasks | robot operators | rank correlation | conventional operators | rank correlation |"
    yield "|---|---:|---:|---:|---:|"
    both = zip(_correlations(tasks, ROBOT), _correlations(tasks, TEXT), strict=True)
    for (pair, count, found), (_, other_count, other) in both:
        if max(count, other_count) >= FEWEST:
            yield f"| {pair} | {count} | {_shown(found)} | {other_count} | {_shown(other)} |"
    means = [_mean_correlation(tasks, family) for family in (ROBOT, TEXT)]
    yield f"| mean | | {means[0]} | | {means[1]} |"
    yield ""


def _correlations(tasks: Mapping[str, Task], family: str) -> list[tuple[str, int, Any]]:
    """Of each pair of tasks: its name, how many operators have a score in both, and the correlation."""
    own = {name: operator_scores(mutants_of(task, family), LEAST) for name, task in tasks.items()}
    found = []
    for first, second in combinations(own, 2):
        both = [name for name in own[first] if name in own[second]]
        ranks = rank_correlation([own[first][name] for name in both], [own[second][name] for name in both])
        found.append((f"{first}, {second}", len(both), ranks if len(both) > 2 else None))
    return found


def _mean_correlation(tasks: Mapping[str, Task], family: str) -> str:
    known = [found[0] for _, _, found in _correlations(tasks, family) if found is not None]
    return f"{fmean(known):.2f} (pairs of tasks: {len(known)})".replace("-", "−") if known else "–"


def _shown(found: Any) -> str:
    if found is None:
        return "–"
    rho, between = found
    shown = f"{rho:.2f}" + (f" ({between.low:.2f} to {between.high:.2f})" if between else "")
    return shown.replace("-", "−")
