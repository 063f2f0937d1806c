"""Prints suggestions to the terminal and as JSON, and keeps them for reports of the campaign."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

from mutabot.api.reports import CommandContext, Results

from .results import Dropped, ProvenCheck, Suggestions, Unsolved

#: lines of a section that are shown; --json has all
_MOST = 10


def print_suggestions(context: CommandContext, found: Suggestions) -> None:
    """Print each check, the mutants it kills and how sure it is, the remaining survivors, and the diff."""
    killed = {mutant for one in found.checks for mutant in one.kills}
    survivors = plural(len(killed) + len(found.unsolved), "survivor")
    context.print(f"{plural(len(found.checks), 'check')} for {len(killed)} of {survivors}")
    for number, one in enumerate(found.checks, start=1):
        context.print_section(f"{number}  {one.test}")
        for line in check_lines(one, found):  # a statement is copied, so that it must not be wrapped
            context.print(f"  {line}")
    left = [one for one in found.unsolved if not one.never]
    never = [one for one in found.unsolved if one.never]
    dropped = [f"{' '.join(one.statement.split())}: {one.reason}" for one in found.dropped]
    sections = {
        f"No check found for {plural(len(left), 'survivor')}": _left(left, found),
        f"{plural(len(never), 'survivor')} cannot be killed by any check in these tests": _left(never, found),
        f"{plural(len(dropped), 'check')} dropped, because verification failed": dropped,
    }
    for name, lines in sections.items():
        if lines:
            context.print_section(name, lines, _MOST)
    if found.diff:
        context.print(f"\n{found.diff.rstrip()}")


def check_lines(one: ProvenCheck, found: Suggestions) -> Iterator[str]:
    """Yield the assertion, what it kills, its tolerance, and its false alarms."""
    yield from one.statement.splitlines()
    yield f"kills {_kills(one, found)}"
    seen = f"{plural(one.runs, 'run')} of the original"
    yield f"{seen} spread {one.spread:.3g}" if one.spread else f"equal in {seen}"
    yield (
        f"false alarms: none in {plural(one.fresh, 'new seed')} "
        f"(so at most {100 * one.unseen:.2g} % of runs, 95 % confidence)"
    )
    if one.by_hand:
        where = f"where `{one.after}` is made" if one.after else "where it ends"
        lines = one.statement.splitlines()
        imports = [f"  {line}" for line in one.by_hand.splitlines() if line not in lines]
        yield f"another tool makes this test: add the check by hand {where}{', with' if imports else ''}"
        yield from imports


def _kills(one: ProvenCheck, found: Suggestions) -> str:
    """Return the mutants by the rounds in which they are killed: ``#7, #9 in all rounds``."""
    by_rounds: dict[tuple[int, ...], list[int]] = {}
    for mutant, rounds in one.kills.items():
        by_rounds.setdefault(tuple(rounds), []).append(found.numbers.get(mutant, 0))
    parts = []
    for rounds, numbers in by_rounds.items():
        several = "s" if len(rounds) > 1 else ""
        where = f" in round{several} {', '.join(str(round + 1) for round in sorted(rounds))}"
        if len(rounds) == found.rounds:
            where = " in all rounds" if found.rounds > 1 else ""
        parts.append(", ".join(f"#{number}" for number in sorted(numbers)) + where)
    return "; ".join(parts)


def plural(count: int, name: str) -> str:
    """Return ``1 check``, ``2 checks``."""
    return f"{count} {name if count == 1 else name + 's'}"


def _left(unsolved: Sequence[Unsolved], found: Suggestions) -> list[str]:
    """Return lines on the survivors by reason, each reason once: the most frequent first."""
    by_reason: dict[str, list[Unsolved]] = {}
    for one in unsolved:
        by_reason.setdefault(one.reason, []).append(one)
    groups = sorted(by_reason.items(), key=lambda group: -len(group[1]))
    return [f"{_named(those, found)}: {reason}" for reason, those in groups]


def _named(those: Sequence[Unsolved], found: Suggestions) -> str:
    if len(those) == 1:
        (one,) = those
        return f"#{found.numbers.get(one.mutant, 0)} {found.descriptions.get(one.mutant, '')}"
    return ", ".join(f"#{number}" for number in sorted(found.numbers.get(one.mutant, 0) for one in those))


def keep(context: CommandContext, results: Results, found: Suggestions) -> None:
    """Keep each survivor's first killing check, or the reason why there is none, for reports."""
    checks: dict[str, tuple[str, str, tuple[str, ...]]] = {}
    for one in reversed(found.checks):
        notes = tuple(check_lines(one, found))[len(one.statement.splitlines()) :]
        checks |= dict.fromkeys(one.kills, (one.test, one.statement, notes))
    context.keep_suggestions(results, checks, {one.mutant: one.reason for one in found.unsolved})


def data_of_suggestions(found: Suggestions) -> dict[str, Any]:
    """Return what ``--json`` prints; docs/suggest.md describes it."""

    def mutant(name: str) -> dict[str, Any]:
        description = found.descriptions.get(name, "")
        return {"id": name, "number": found.numbers.get(name), "description": description}

    def kills(one: ProvenCheck) -> list[dict[str, Any]]:
        return [
            {"mutant": mutant(name), "rounds": [round + 1 for round in rounds]}
            for name, rounds in one.kills.items()
        ]

    return {
        "rounds": found.rounds,
        "seeds": found.seeds,
        "suggestions": [{**_facts(one), "kills": kills(one)} for one in found.checks],
        "diff": found.diff,
        "unsolved": [{**_facts(one), "mutant": mutant(one.mutant)} for one in found.unsolved],
        "dropped": [_facts(one) for one in found.dropped],
    }


def _facts(one: ProvenCheck | Unsolved | Dropped) -> dict[str, Any]:
    """Return the fields of a dataclass that are not None."""
    return {name: value for name, value in asdict(one).items() if value is not None}
