"""Proposed entries as the text of a vocabulary file."""

from __future__ import annotations

import re
from collections.abc import Iterator

from mutabot.proposal.toml import key_text, quantity_line, short, value_text

from .entries import Described, Entry

#: parts without a meaning that are shown, and values of each
_MOST_UNTOLD, _EXAMPLES = 16, 3
_DONE = {
    "topic": "messages", "service": "calls", "action": "goals, feedback and results", "parameter": "readings",
    "timer": "ticks", "rate": "turns", "tf": "readings",
}  # fmt: skip


def entry_text(entry: Entry) -> str:
    """One ``[[operation]]``, with what nothing tells as a comment."""
    name = entry.name.replace(" → ", " -> ")
    lines = [f"[[operation]]  # {_where(entry)}", f"{entry.key} = {value_text(name)}"]
    if entry.direction:
        lines.append(f"direction = {value_text(entry.direction)}")
    if entry.type:
        lines.append(f"type = {value_text(entry.type)}")
    told = [part for part in entry.parts if part.guess is not None]
    lines += [quantity_line(_key(part), part.guess, _seen(part)) for part in told if part.guess is not None]
    lines += _refused(entry)
    lines += _untold([part for part in entry.parts if part.guess is None and not _says_no(part)])
    return "\n".join(lines)


def _where(entry: Entry) -> str:
    count = sum(use.count for use in entry.uses)
    file, line, _ = entry.uses[0].sites[0]
    what = _DONE[entry.key]
    return f"seen: {count} {what.removesuffix('s') if count == 1 else what}, first at {file}:{line}"


def _refused(entry: Entry) -> Iterator[str]:
    """How it may say no, by the conventions of ROS: that is for the user to decide."""
    if any(_says_no(part) for part in entry.parts):
        yield '# refused = { path = "success", values = [false] }  # if that is how it refuses a command'
    if entry.key == "action":
        yield '# refused = ["ABORTED", "REJECTED"]  # if goals that end so were refused'


def _says_no(part: Described) -> bool:
    return part.table == "response" and part.path == "success" and part.part.type in ("bool", "boolean")


def _untold(parts: list[Described]) -> Iterator[str]:
    if not parts:
        return
    shown = [f"{_key(part)} ({'; '.join(filter(None, (part.part.type, _seen(part))))})" for part in parts]
    more = f", and {len(shown) - _MOST_UNTOLD} more" if len(shown) > _MOST_UNTOLD else ""
    yield f"# nothing tells what this means: {', '.join(shown[:_MOST_UNTOLD])}{more}"


def _key(part: Described) -> str:
    return f"{part.table}.{key_text(part.path)}" if part.path else part.table


def _seen(part: Described) -> str:
    values = part.part.values
    elements = re.search(r"\[(\d+):(\d+)\]$", part.path)
    if elements is not None and part.path != part.part.path:
        values = tuple(value[int(elements[1]) : int(elements[2])] for value in values)
    texts = [short(value) for value in values[: 1 if part.part.length is not None else _EXAMPLES]]
    return ", ".join(texts) + (", …" if len(values) > len(texts) else "")
