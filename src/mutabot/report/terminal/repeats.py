"""What repeats say about false kills and false survivors, on the terminal."""

from __future__ import annotations

from collections.abc import Iterator

from rich.text import Text

from mutabot.analysis.chance import Estimate, false_kills, false_survivors
from mutabot.journal.records import Repeated, Repeats

from .console import plural


def repeat_lines(repeats: Repeats) -> Iterator[Text]:
    """How many outcomes were run once more, and how many of the others may be wrong; nothing if none was."""
    doubted, others, survivors = repeats.doubted, repeats.others, repeats.survivors
    if doubted.outcomes or others.repeated:
        yield _line(_kills_text(doubted, others, false_kills(repeats)), doubted.changed + others.changed)
    if survivors.repeated:
        found = false_survivors(repeats)
        text = f"Survivors: {_repeated(survivors)}; {_estimate('false survivors', found)}."
        yield _line(text, survivors.changed)


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


def _line(text: str, changed: int) -> Text:
    return Text(f"\n{text}", style="bold red" if changed else "dim", overflow="fold")
