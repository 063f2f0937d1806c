"""Writes proposed operations as a vocabulary file: valid lines, and comments with questions."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from typing import Any, TypeGuard

from .guess import Guess
from .messages import DescribedPart, MessageEntry
from .observations import ANY, WatchedPart
from .operations import Proposal

_BARE = re.compile(r"[A-Za-z0-9_-]+")
#: the longest text that is shown as an example, and values of each part
_LONGEST, _EXAMPLES = 60, 4
#: notes that many operations may have
_ON_MOCK = "  # seen on a mock or a fake that stands for it"
_PLAIN = "  # it is left out and made twice; say what its values mean"
_DONE = {
    "topic": "message", "service": "call", "action": "goal, feedback or result", "parameter": "reading",
    "timer": "tick", "rate": "turn", "tf": "reading",
}  # fmt: skip


def vocabulary_text(drafts: Sequence[Proposal | MessageEntry], program: Sequence[str]) -> str:
    """Return the text of the vocabulary file; what would not load is at its end, as comments."""
    head = (
        f"# Drafted by `mutabot init` from {', '.join(program)}. Lines follow from names, docstrings and\n"
        "# values that were seen. Where a line asks a `question:`, correct it and take its number sign away."
    )
    texts = [
        (entry_text(draft) if isinstance(draft, MessageEntry) else operation_text(draft), draft)
        for draft in drafts
    ]
    clocks = [_clock_line(draft.target) for draft in drafts if _is_clock(draft)]
    blocks = [head, *clocks, *(text for text, draft in texts if draft.is_taken)]
    others = [_commented(text) for text, draft in texts if not (draft.is_taken or _is_clock(draft))]
    if others:
        blocks.append(
            "# Also seen, but nothing shows what it means to the robot. For an operation, take the number\n"
            "# signs away and say what its arguments or its result mean."
        )
    return _with_notes_once("\n\n".join([*blocks, *others]) + "\n")


def probe_text(readings: Sequence[str]) -> str:
    """Return how a reading becomes a probe, as a comment; ``readings``: those that need no arguments."""
    return (
        "\n# To compare survivors with the original, name a reading that shows how a test ended:\n"
        f"# [[probe]]\n# call = {value_text(readings[0] if readings else '…')}\n# tolerance = 0.001\n"
    )


def _is_clock(draft: Proposal | MessageEntry) -> TypeGuard[Proposal]:
    return isinstance(draft, Proposal) and draft.is_clock


def _clock_line(target: str) -> str:
    clock = f"{{ tick = {value_text(target)}, step = 0.01 }}"
    return f"# clock = {clock}  # question: how many seconds of simulated time does each call take?"


def _with_notes_once(text: str) -> str:
    """Return the text with each general note only at its first line."""
    for note in (_ON_MOCK, _PLAIN):
        first, found, rest = text.partition(note)
        text = f"{first}{found}{rest.replace(note, '')}"
    return text


def questions_in(text: str) -> int:
    """Return how many questions a draft asks."""
    return len(re.findall(r"# question: ", text))


def key_text(path: str) -> str:
    """Return a TOML key, in quotes if necessary."""
    return path if _BARE.fullmatch(path) else value_text(path)


def value_text(value: Any) -> str:
    """Return a TOML value."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key_text(key)} = {value_text(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join("…" if item == "…" else value_text(item) for item in value) + "]"
    return json.dumps(value, ensure_ascii=False)


def short(value: Any) -> str:
    """Return a value as a short example."""
    if isinstance(value, list):
        return f"[{', '.join(map(short, value[:8]))}{', …' if len(value) > 8 else ''}]"
    if isinstance(value, float):
        return f"{value:.4g}"
    text = value_text(value)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 1] + "…"


def _line(table: str, path: str, part: WatchedPart, guess: Guess | None) -> str:
    """Return the line of a quantity, or a comment with the question that remains."""
    key, seen = f"{table}.{key_text(path)}" if path else table, _examples(part, path)
    if guess is None:
        return f"# {key}  # seen: {seen or part.type or 'nothing'}"
    asked = [] if guess.is_sure else [f"question: {' '.join(guess.questions)}"]
    notes = [*asked, *filter(None, (guess.note, f"seen: {seen}" if seen else ""))]
    line = f"{'# ' if asked else ''}{key} = {value_text(guess.table)}"
    return f"{line}  # {'; '.join(notes)}" if notes else line


def operation_text(proposal: Proposal) -> str:
    """Return an ``[[operation]]``, with what is unknown as comments."""
    call = proposal.call
    done = "assignment" if call.is_set or call.name == "__setitem__" else "call"
    lines = [f"[[operation]]  # seen: {counted(call.count, done)}, first at {next(iter(call.sites), '?')}"]
    if call.problem:
        lines.append(f"# {call.problem}")
    lines += _subject(proposal)
    is_asked = not any(guess.is_sure for guess in [*proposal.arguments.values(), *proposal.result.values()])
    if proposal.doubt:
        lines.append(f"command = true  # question: {proposal.doubt}")
    elif proposal.is_plain:
        lines.append(f"command = true{_PLAIN}")
    elif proposal.is_operation and is_asked and proposal.message is None:
        lines.append("command = true")
    any_object = f"{ANY}."
    references = (
        ("current", (proposal.current or "").removeprefix(any_object)),
        ("opposite", (proposal.opposite or "").removeprefix(any_object)),
        ("refusals", proposal.refusals),
        ("message", proposal.message),
    )
    lines += [f"{key} = {value_text(value)}" for key, value in references if value]
    lines += _arguments(proposal)
    if proposal.message is not None:
        return "\n".join([*lines, *_pattern_lines(proposal)])
    for part in call.result.parts.values():
        lines += _lines("result", part, proposal.result)
    return "\n".join(lines)


def _subject(proposal: Proposal) -> Iterator[str]:
    """Yield the lines that say what is called."""
    call = proposal.call
    is_any = call.target.startswith(ANY)
    why = _ON_MOCK if call.stands_in and not is_any else ""
    if is_any:
        yield f"method = {value_text(call.name)}  # of any object: the tests stand in for the robot"
    else:
        yield f"call = {value_text(call.target)}{why}"
    if call.signature and (is_any or call.is_documented):
        yield f"signature = {value_text(call.signature)}"
    elif not call.signature and call.arguments and not call.positional.times:  # of a mock, which has no order
        yield f'signature = "({", ".join(f"{name}=…" for name in call.arguments)})"'


def _commented(text: str) -> str:
    return "\n".join(line if line.startswith("#") else f"# {line}" for line in text.splitlines())


def counted(count: int, noun: str) -> str:
    """Return a number with its noun: ``1 call``, ``2 calls``."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _arguments(proposal: Proposal) -> Iterator[str]:
    call = proposal.call
    if proposal.message is not None and proposal.message == call.discriminator:
        if call.other_commands:
            others = counted(call.other_commands, "more call")
            yield f"# {others} without one name in {call.discriminator}, as of a list: mutated as a whole"
        return  # each command says what is beside it
    for name, values in call.arguments.items():
        for part in values.parts.values() if name != proposal.message else ():
            yield from _lines("arguments", part, proposal.arguments)
    if call.positional.times:
        parts = sorted(call.positional.parts.values(), key=lambda part: part.path)
        shown = ", ".join(short(part.values[0]) if part.values else part.type for part in parts)
        yield f'# signature = "(…)"  # the names of its arguments are unknown; seen: ({shown})'


def _lines(table: str, part: WatchedPart, guesses: dict[str, Guess]) -> Iterator[str]:
    """Yield the lines of a part: its guesses, else a comment with the observed values."""
    mine = {path: guess for path, guess in guesses.items() if _belongs(path, part)}
    for path, guess in mine.items():
        yield _line(table, path, part, guess)
    if not mine and (part.values or part.length or table == "arguments"):
        yield _line(table, part.path, part, None)


def _belongs(path: str, part: WatchedPart) -> bool:
    """Return whether a guess is about this part, or about elements of it."""
    return path == part.path or (part.length is not None and path.rpartition("[")[0] == part.path)


def _examples(part: WatchedPart, path: str = "") -> str:
    """Return the observed values of the elements that the path names."""
    step = re.search(r"\[(\d+)(?::(\d+))?\]$", path) if part.length is not None else None
    values = part.values[:_EXAMPLES]
    if step is not None and path != part.path:
        first = int(step[1])
        values = [
            value[first : int(step[2])] if step[2] else value[first] for value in values if len(value) > first
        ]
    texts = [short(value) for value in values[: 1 if part.length is not None else _EXAMPLES]]
    return ", ".join(texts) + (", …" if len(part.values) > len(texts) else "")


def _pattern_lines(proposal: Proposal) -> list[str]:
    rows = []
    for text, guess in proposal.patterns:
        asked = guess.questions and guess.table
        fields = {} if asked else guess.table
        opposite = {key: value for key, value in guess.table.items() if key == "opposite"}
        rest = value_text({key: value for key, value in guess.table.items() if key != "opposite"})
        notes = [f"question: {' '.join(guess.questions)}{f' {rest}' if asked else ''}"] * bool(
            guess.questions
        )
        notes += [f"seen: {guess.note}"] if guess.note else []
        is_open = guess.questions and not guess.table
        rows.append(
            f"  {'# ' if is_open else ''}{value_text({'text': text, **fields, **opposite})},"
            + (f"  # {'; '.join(notes)}" if notes else "")
        )
    lines = ["patterns = [", *rows, "]"]
    if not proposal.reads_by_name:
        return lines
    if not all(guess.table for _, guess in proposal.patterns):
        hint = '{ text = "color", result = { kind = "label", values = ["red", "blue"] } }'
        lines.insert(0, f"# question: what does each pattern read? as in: {hint}")
    return ["command = false", *lines]


def entry_text(entry: MessageEntry) -> str:
    """Return an ``[[operation]]`` of a middleware, with what is unknown as a comment."""
    count = sum(sum(use.sites.values()) for use in entry.uses)
    where = f"{counted(count, _DONE[entry.key])}, first at {next(iter(entry.uses[0].sites))}"
    lines = [
        f"[[operation]]  # seen: {where}",
        f"{entry.key} = {value_text(entry.name.replace(' → ', ' -> '))}",
    ]
    if entry.direction:
        lines.append(f"direction = {value_text(entry.direction)}")
    if entry.type:
        lines.append(f"type = {value_text(entry.type)}")
    lines += [
        _line(part.table, part.path, part.part, part.guess)
        for part in entry.parts
        if part.guess is not None or not _says_no(part)
    ]
    if any(map(_says_no, entry.parts)):
        lines.append(
            '# refused = { path = "success", values = [false] }  # question: is that how it refuses?'
        )
    if entry.key == "action":
        lines.append('# refused = ["ABORTED", "REJECTED"]  # question: were goals that end so refused?')
    return "\n".join(lines)


def _says_no(part: DescribedPart) -> bool:
    return part.table == "response" and part.path == "success" and part.part.type in ("bool", "boolean")
