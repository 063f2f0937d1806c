"""Proposed operations as the text of a vocabulary file, with what is to be looked at."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from typing import Any

from mutabot.init.compared import Unreached
from mutabot.init.guess import Guess, is_complete
from mutabot.init.named.entries import Described, Entry
from mutabot.init.observed import Part, SeenCall
from mutabot.init.operations import Proposal
from mutabot.model import ANY

_BARE = re.compile(r"[A-Za-z0-9_-]+")
#: the longest text that is shown as an example
_LONGEST = 60


def key_text(path: str) -> str:
    """A key, in quotes if it needs any."""
    return path if _BARE.fullmatch(path) else value_text(path)


def value_text(value: Any) -> str:
    """A value."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key_text(key)} = {value_text(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(value_text(item) for item in value) + "]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    return json.dumps(value)


def short(value: Any) -> str:
    """A value as an example."""
    if isinstance(value, list):
        shown = ", ".join(short(one) for one in value[:8])
        return f"[{shown}{', …' if len(value) > 8 else ''}]"
    if isinstance(value, float):
        return f"{value:.4g}"
    text = value_text(value)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 1] + "…"


def quantity_line(key: str, guess: Guess, seen: str) -> str:
    """A quantity, marked as a guess; a comment if a vocabulary would not take it."""
    shown = f"; seen: {seen}" if seen and seen != "nothing" else ""
    if not is_complete(guess):
        table = value_text({**guess.table, "values": ["…", "…"]})
        return f"# {key} = {table}  # guess: give all values it can have{shown}"
    checks = f"; check the {' and the '.join(guess.checks)}" if guess.checks else ""
    return f"{key} = {value_text(guess.table)}  # guess{checks}{shown}"


#: values shown as an example
_EXAMPLES = 4
_MOST_UNREACHED = 40


def vocabulary_text(
    found: Sequence[Proposal],
    others: Sequence[Proposal],
    program: Sequence[str],
    unreached: Sequence[Unreached] = (),
    named: Sequence[Entry] = (),
) -> str:
    """The vocabulary file."""
    blocks = [
        f"# Proposed by `mutabot init` from {', '.join(program)}. What things mean is guessed from names\n"
        "# and values: correct what is wrong, and take out what is no operation. `mutabot check` tries it.",
        *(entry_text(entry) for entry in named if entry.is_taken),
        *(operation_text(proposal) for proposal in found),
    ]
    blocks += [_commented(entry_text(entry)) for entry in named if not entry.is_taken]
    if others:
        blocks.append(
            "# Also called, but nothing shows what it means to the robot. For what is an operation, take\n"
            "# the number signs away and say what its arguments or its result mean.\n\n"
            + "\n\n".join(_commented(operation_text(proposal)) for proposal in others)
        )
    if unreached:
        lines = [f"#   {one.file}:{one.line}  {one.callee}" for one in unreached[:_MOST_UNREACHED]]
        blocks.append(
            "# Calls that no test reaches; what is never called cannot be mutated:\n" + "\n".join(lines)
        )
    return "\n\n".join(blocks) + "\n"


def operation_text(proposal: Proposal) -> str:
    """One ``[[operation]]``, with what is not known as comments."""
    call = proposal.call
    lines = [f"[[operation]]  # {_where(call)}"]
    if call.facts["problem"]:
        lines.append(f"# {call.facts['problem']}")
    lines += _subject(proposal)
    if proposal.is_plain:
        lines.append("command = true  # guess: it is skipped and repeated; say what its values mean")
    lines += [f"{key} = {value_text(value)}  # guess" for key, value in _references(proposal)]
    lines += _arguments(proposal)
    lines += _results(proposal)
    if proposal.message is not None:
        lines += _pattern_lines(proposal)
    return "\n".join(lines)


def _subject(proposal: Proposal) -> Iterator[str]:
    """What is called."""
    call = proposal.call
    if not call.target.startswith(ANY):
        yield f"call = {value_text(call.target)}"
        return
    yield f"method = {value_text(call.name)}  # of whatever object has it: the tests stand in for the robot"
    if call.facts["has_signature"]:
        yield f"signature = {value_text(call.facts['signature'])}"
    elif call.arguments and not call.positional:  # of a mock, which tells no order
        names = ", ".join(f"{name}=…" for name in call.arguments)
        yield f'signature = "({names})"  # guess'


def _commented(text: str) -> str:
    return "\n".join(line if line.startswith("#") else f"# {line}" for line in text.splitlines())


def _where(call: SeenCall) -> str:
    if not call.sites:
        return "not called by the program; tells where the robot is"
    file, line, _ = call.sites[0]
    return f"seen: {call.count} {'call' if call.count == 1 else 'calls'}, first at {file}:{line}"


def _references(proposal: Proposal) -> list[tuple[str, Any]]:
    current, opposite = (one and one.removeprefix(f"{ANY}.") for one in (proposal.current, proposal.opposite))
    pairs: list[tuple[str, Any]] = [
        ("current", current), ("opposite", opposite), ("refusals", proposal.refusals),
        ("message", proposal.message),
    ]  # fmt: skip
    return [(key, value) for key, value in pairs if value]


def _arguments(proposal: Proposal) -> Iterator[str]:
    if proposal.message is not None and proposal.message == proposal.call.told_by:
        return  # each command says what is beside it
    for name, parts in proposal.call.arguments.items():
        if name == proposal.message:
            continue
        for part in parts:
            mine = {path: guess for path, guess in proposal.arguments.items() if _belongs(path, part)}
            yield from (
                quantity_line(f"arguments.{key_text(path)}", guess, _examples(part, path))
                for path, guess in mine.items()
            )
            if not mine:
                yield f"# arguments.{key_text(part.path)}  # seen: {_examples(part)}"
    if proposal.call.positional:
        firsts = {part.path.partition("[")[0]: _first(part) for part in reversed(proposal.call.positional)}
        values = ", ".join(firsts[name] for name in sorted(firsts))
        yield f'# signature = "(…)"  # nothing tells its arguments\' names; seen: ({values})'


def _first(part: Part) -> str:
    return short(part.values[0]) if part.values else part.type


def _results(proposal: Proposal) -> Iterator[str]:
    if proposal.message is not None:
        return
    for part in proposal.call.result:
        mine = {path: guess for path, guess in proposal.result.items() if _belongs(path, part)}
        for path, guess in mine.items():
            yield quantity_line(_result_key(path), guess, _examples(part, path))
        if not mine and (part.values or part.length):
            yield f"# {_result_key(part.path)}  # seen: {_examples(part)}"


def _result_key(path: str) -> str:
    return f"result.{key_text(path)}" if path else "result"


def _belongs(path: str, part: Part) -> bool:
    """Whether a guess is about this part, or about elements of it."""
    return path == part.path or (part.length is not None and path.rpartition("[")[0] == part.path)


def _examples(part: Part, path: str = "") -> str:
    """Values that were seen, of the elements that the path names."""
    step = re.search(r"\[(\d+)(?::(\d+))?\]$", path) if part.length is not None else None
    values = part.values[:_EXAMPLES]
    if step is not None and path != part.path:
        first = int(step[1])
        cut = [one[first : int(step[2])] if step[2] else one[first] for one in values if len(one) > first]
        values = tuple(cut)
    texts = [short(value) for value in values[: 1 if part.length is not None else _EXAMPLES]]
    more = ", …" if len(part.values) > len(texts) else ""
    return (", ".join(texts) + more) if texts else part.type or "nothing"


def _pattern_lines(proposal: Proposal) -> list[str]:
    rows = []
    for text, guess in proposal.patterns:
        checks = f"  # check the {' and the '.join(guess.checks)}" if guess.checks else ""
        checks += f"  # seen: {guess.seen}" if guess.seen else ""
        rows.append(f"  {value_text({'text': text, **guess.table})},{checks}")
    lines = ["patterns = [", *rows, "]"]
    if proposal.reads_by_name and all(guess.table for _, guess in proposal.patterns):
        return ["command = false  # guess: it only reads", *lines]
    if proposal.reads_by_name:
        hint = (
            'what it reads, as in: { text = "color", result = { kind = "label", values = ["red", "blue"] } }'
        )
        lines = ["command = false  # guess: it only reads", f"# give each pattern {hint}", *lines]
    return lines


#: parts without a meaning that are shown, and values of each
_MOST_UNTOLD, _FEW = 16, 3
_DONE = {
    "topic": "messages", "service": "calls", "action": "goals, feedback and results", "parameter": "readings",
    "timer": "ticks", "rate": "turns", "tf": "readings",
}  # fmt: skip


def entry_text(entry: Entry) -> str:
    """One ``[[operation]]``, with what nothing tells as a comment."""
    name = entry.name.replace(" → ", " -> ")
    lines = [f"[[operation]]  # {_where_named(entry)}", f"{entry.key} = {value_text(name)}"]
    if entry.direction:
        lines.append(f"direction = {value_text(entry.direction)}")
    if entry.type:
        lines.append(f"type = {value_text(entry.type)}")
    told = [part for part in entry.parts if part.guess is not None]
    lines += [quantity_line(_key(part), part.guess, _seen(part)) for part in told if part.guess is not None]
    lines += _refused(entry)
    lines += _untold([part for part in entry.parts if part.guess is None and not _says_no(part)])
    return "\n".join(lines)


def _where_named(entry: Entry) -> str:
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
    texts = [short(value) for value in values[: 1 if part.part.length is not None else _FEW]]
    return ", ".join(texts) + (", …" if len(values) > len(texts) else "")
