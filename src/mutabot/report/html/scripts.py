"""Data as scripts: from disk, a page may load no other files than scripts, style sheets and pictures."""

from __future__ import annotations

import json
import math
from typing import Any

#: what could end the script or its string, whatever reads it first: the page's parser or the language's
_ESCAPES = str.maketrans(
    {
        "\\": "\\\\",
        "'": "\\'",
        "<": "\\x3c",
        ">": "\\x3e",
        "&": "\\x26",
        "\u2028": "\\u2028",
        "\u2029": "\\u2029",
        "\r": "\\r",
        "\n": "\\n",
    }
)
#: as much as this is told with all its digits; and up to this, whole numbers are whole to the page as well
_EXACT, _WHOLE = 1e4, 2**53


def script_of(name: str, data: Any) -> str:
    """A script that hands data to the page under a name.

    The data are a text that is parsed as JSON: no key of theirs means anything to the language.
    """
    text = json.dumps(plain(data), ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return f"mutabot.take('{name.translate(_ESCAPES)}','{text.translate(_ESCAPES)}');\n"


def plain(value: Any) -> Any:
    """Data that JSON can hold: numbers that are none become null, and what it does not know a text."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return _short(value) if math.isfinite(value) else None
    if value is None or isinstance(value, bool | int):
        return value
    return str(value)


def _short(number: float) -> float | int:
    """As many digits as a page shows, so that thousands of numbers stay small.

    From ``_EXACT`` on these are too few: of seconds since 1970, seven digits are some minutes.
    """
    if number.is_integer() and abs(number) < _WHOLE:
        return int(number)
    return number if abs(number) >= _EXACT else float(f"{number:.7g}")
