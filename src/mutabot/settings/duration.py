"""How long something may take, as a user writes it: ``90s``, ``10m``, ``1h30m``."""

from __future__ import annotations

import re

from mutabot import limits
from mutabot.errors import UsageError
from mutabot.limits import shortened

_PART = re.compile(r"(\d{1,12}(?:\.\d{1,12})?)\s*(h|min|m|s)")
_SECONDS = {"h": 3600.0, "min": 60.0, "m": 60.0, "s": 1.0}


def seconds_of(text: str) -> float:
    """What ``90s``, ``10m`` or ``1h 30m`` says, in seconds. Raises UsageError for anything else."""
    plain, text = text.strip().lower(), shortened(text)
    parts = _PART.findall(plain)
    if not parts or _PART.sub("", plain).strip():
        raise UsageError(f"--budget {text}: no length of time; write 90s, 10m or 1h30m")
    found = sum(float(number) * _SECONDS[unit] for number, unit in parts)
    if found <= 0:
        raise UsageError(f"--budget {text}: nothing can be run in it; write 90s, 10m or 1h30m")
    if found > limits.BUDGET:
        raise UsageError(f"--budget {text}: at most {limits.BUDGET // 3600:,} hours can be meant")
    return found


def in_words(seconds: float) -> str:
    """``10 min``, ``1 h 30 min``, ``90 s``."""
    if seconds < 120 and seconds % 60:
        return f"{seconds:g} s"
    minutes, left = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    parts = [(hours, "h"), (minutes, "min"), (left, "s")]
    return " ".join(f"{number} {unit}" for number, unit in parts if number)
