"""Parts of a vocabulary's text: keys, values, and quantities with what is to be looked at."""

from __future__ import annotations

import json
import re
from typing import Any

from .guess import Guess, is_complete

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
