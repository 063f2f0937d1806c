"""Errors, told before anything else: what they hit is not judged, and no score knows of it."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import RenderableType
from rich.padding import Padding
from rich.text import Text

from mutabot.analysis.divergence import first_line
from mutabot.analysis.results import Results
from mutabot.model import Verdict

from .console import plain, plural

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
