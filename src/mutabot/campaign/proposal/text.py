"""Proposed operations as the text of a vocabulary file."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import Any

from .guess import Guess
from .operations import Proposal
from .uses import Use

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def vocabulary_text(found: Sequence[Proposal], others: Sequence[Use], program: Sequence[str]) -> str:
    """The vocabulary file."""
    blocks = [
        f"# Proposed by `mutabot init` from {', '.join(program)}. Everything here is guessed from names:\n"
        "# correct what is wrong, and take out what is no operation. `mutabot check` tries it.",
        *(operation_text(proposal) for proposal in found),
    ]
    if others:
        names = "\n".join(f"#   {use.definition.target}" for use in others)
        blocks.append(f"# Also used, but nothing shows what it means to the robot:\n{names}")
    return "\n\n".join(blocks) + "\n"


def operation_text(proposal: Proposal) -> str:
    """One ``[[operation]]``; commented out as a whole if it cannot be completed by guessing."""
    node = proposal.definition.node
    sure = "" if proposal.certain else "; guess: only its name says that this is what is called"
    lines = [f"[[operation]]  # {proposal.definition.module.path.name}:{node.lineno}{sure}"]
    lines.append(f"call = {_toml(proposal.target)}")
    lines += [f"{key} = {_toml(value)}  # guess" for key, value in _references(proposal)]
    lines += [_quantity(f"arguments.{_key(path)}", guess) for path, guess in proposal.arguments.items()]
    lines += [
        _quantity(f"result.{_key(path)}" if path else "result", guess)
        for path, guess in proposal.result.items()
    ]
    if proposal.message is not None:
        lines += _pattern_lines(proposal)
    if proposal.is_reading and not any(_is_complete(guess) for guess in proposal.result.values()):
        lines = [line if line.startswith("#") else f"# {line}" for line in lines]
    return "\n".join(lines)


def _references(proposal: Proposal) -> list[tuple[str, Any]]:
    pairs: list[tuple[str, Any]] = [
        ("current", proposal.current), ("opposite", proposal.opposite), ("refusals", proposal.refusals),
        ("message", proposal.message),
    ]  # fmt: skip
    return [(key, value) for key, value in pairs if value]


def _quantity(key: str, guess: Guess) -> str:
    if not _is_complete(guess):
        table = _toml({**guess.table, "values": ["…", "…"]})
        return f"# {key} = {table}  # guess: give all values it can have"
    checks = f"; check the {' and the '.join(guess.checks)}" if guess.checks else ""
    return f"{key} = {_toml(guess.table)}  # guess{checks}"


def _is_complete(guess: Guess) -> bool:
    return guess.table.get("kind") != "label" or "values" in guess.table


def _pattern_lines(proposal: Proposal) -> list[str]:
    rows = []
    for text, guess in proposal.patterns:
        checks = f"  # check the {' and the '.join(guess.checks)}" if guess.checks else ""
        rows.append(f"  {_toml({'text': text, **guess.table})},{checks}")
    lines = ["patterns = [", *rows, "]"]
    if proposal.reads_by_name:
        hint = (
            'what it reads, as in: { text = "color", result = { kind = "label", values = ["red", "blue"] } }'
        )
        lines = ["command = false  # guess: it only reads", f"# give each pattern {hint}", *lines]
    return lines


def _key(path: str) -> str:
    return path if _BARE.fullmatch(path) else _toml(path)


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    return json.dumps(value)
