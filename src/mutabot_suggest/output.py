"""Prints suggestions to the terminal and as JSON, and keeps them for reports of the campaign."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

from mutabot.api.reports import CommandContext, Results

from .project import in_one_line
from .results import Dropped, ProvenCheck, Suggestions, Unsolved

#: lines of a section that are shown; --json has all
_MOST = 10


def print_suggestions(context: CommandContext, found: Suggestions) -> None:
    """Print each check, the mutants it kills and how sure it is, the remaining survivors, and the diff."""
    killed = {mutant for proven in found.checks for mutant in proven.kills}
    survivors = plural(len(killed) + len(found.unsolved), "survivor")
    checks = f"{plural(len(found.checks), 'check')} for {len(killed)}" if found.checks else "No check for any"
    context.print(f"{checks} of {survivors}")
    proofs = {tuple(_proof_lines(check)) for check in found.checks}
    is_shared = len(found.checks) > 1 and len(proofs) == 1
    for number, check in enumerate(found.checks, start=1):
        context.print_section(f"{number}  {check.test}")
        for line in check_lines(check, found, with_proof=not is_shared):
            context.print(f"  {line}")  # a statement is copied, so that it must not be wrapped
    if is_shared:
        context.print_section(f"Each of the {len(found.checks)} checks", proofs.pop())
    left = [survivor for survivor in found.unsolved if not survivor.never]
    never = [survivor for survivor in found.unsolved if survivor.never]
    dropped = [f"{in_one_line(each.statement)}: {each.reason}" for each in found.dropped]
    sections = {
        f"No check found for {plural(len(left), 'survivor')}": _left(left, found),
        f"No check was searched for {plural(len(never), 'survivor')}": _left(never, found),
        f"{plural(len(dropped), 'check')} dropped, because verification failed": dropped,
    }
    for name, lines in sections.items():
        if lines:
            context.print_section(name, lines, _MOST)
    if found.diff:
        context.print(f"\n{found.diff.rstrip()}")


def check_lines(check: ProvenCheck, found: Suggestions, *, with_proof: bool = True) -> Iterator[str]:
    """Yield the assertion, what it kills, its proof unless that is left out, and how to add it by hand."""
    yield from check.statement.splitlines()
    yield f"kills {_kills(check, found)}"
    if with_proof:
        yield from _proof_lines(check)
    if check.by_hand:
        where = f"where `{check.after}` is made" if check.after else "where it ends"
        lines = check.statement.splitlines()
        imports = [f"  {line}" for line in check.by_hand.splitlines() if line not in lines]
        with_imports = ", with" if imports else ""
        yield f"this test is generated, as by pytest-bdd: add the check by hand {where}{with_imports}"
        yield from imports


def _proof_lines(check: ProvenCheck) -> Iterator[str]:
    """Yield how far the original spreads, and how often the check failed on it."""
    seen = f"{plural(check.runs, 'run')} of the original"
    yield f"held in {seen}{f', whose values spread by {check.spread:.3g}' if check.spread else ''}"
    yield (
        f"false alarms: none in {plural(check.fresh, 'new seed')} "
        f"(so at most {100 * check.unseen:.2g} % of runs, 95 % confidence)"
    )


def _kills(check: ProvenCheck, found: Suggestions) -> str:
    """Return the mutants by the rounds in which they are killed: ``#7, #9 in all rounds``."""
    by_rounds: dict[tuple[int, ...], list[int]] = {}
    for mutant, rounds in check.kills.items():
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
    for survivor in unsolved:
        by_reason.setdefault(survivor.reason, []).append(survivor)
    groups = sorted(by_reason.items(), key=lambda group: -len(group[1]))
    return [f"{_named(those, found)}: {reason}" for reason, those in groups]


def _named(those: Sequence[Unsolved], found: Suggestions) -> str:
    if len(those) == 1:
        (survivor,) = those
        return f"#{found.numbers.get(survivor.mutant, 0)} {found.descriptions.get(survivor.mutant, '')}"
    return ", ".join(f"#{number}" for number in sorted(found.numbers.get(entry.mutant, 0) for entry in those))


def keep(context: CommandContext, results: Results, found: Suggestions) -> None:
    """Keep each survivor's first killing check, or the reason why there is none, for reports."""
    checks: dict[str, tuple[str, str, tuple[str, ...]]] = {}
    for check in reversed(found.checks):
        notes = tuple(check_lines(check, found))[len(check.statement.splitlines()) :]
        checks |= dict.fromkeys(check.kills, (check.test, check.statement, notes))
    context.keep_suggestions(
        results, checks, {survivor.mutant: survivor.reason for survivor in found.unsolved}
    )


def data_of_suggestions(found: Suggestions) -> dict[str, Any]:
    """Return what ``--json`` prints; docs/suggest.md describes it."""

    def mutant(name: str) -> dict[str, Any]:
        description = found.descriptions.get(name, "")
        return {"id": name, "number": found.numbers.get(name), "description": description}

    def kills(check: ProvenCheck) -> list[dict[str, Any]]:
        return [
            {"mutant": mutant(name), "rounds": [round + 1 for round in rounds]}
            for name, rounds in check.kills.items()
        ]

    return {
        "rounds": found.rounds,
        "seeds": found.seeds,
        "suggestions": [{**_facts(check), "kills": kills(check)} for check in found.checks],
        "diff": found.diff,
        "unsolved": [{**_facts(survivor), "mutant": mutant(survivor.mutant)} for survivor in found.unsolved],
        "dropped": [_facts(check) for check in found.dropped],
    }


def _facts(entry: ProvenCheck | Unsolved | Dropped) -> dict[str, Any]:
    """Return the fields of a dataclass that are not None."""
    return {name: value for name, value in asdict(entry).items() if value is not None}
