"""Keys of the configuration that the command line sets: ``-o KEY=VALUE``."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Sequence
from typing import Any

from mutabot.errors import UsageError

#: parts of a key at most: a table and a key in it
_DEPTH = 2


def overridden(raw: dict[str, Any], texts: Sequence[str], lists: Collection[str]) -> dict[str, Any]:
    """A table of the configuration with what ``KEY=VALUE`` says instead of its own keys.

    A value is written as in TOML; what is no TOML is a text, so ``-o when=once`` needs no quotation marks. A
    text for one of the keys in ``lists`` (``TABLE.KEY`` in a table) is a list of one.

    Raises UsageError for a text that is not of this form.
    """
    found = dict(raw) if texts else raw
    for text in texts:
        key, sign, value = text.partition("=")
        parts = [part.strip() for part in key.split(".")]
        if not sign or not all(parts) or len(parts) > _DEPTH:
            raise UsageError(f"-o {text}: write KEY=VALUE, such as -o rounds=5 or -o cluster.ca=ca.pem")
        table, last = found, parts[-1]
        if len(parts) == _DEPTH:
            inner = found.get(parts[0])
            found[parts[0]] = table = dict(inner) if isinstance(inner, dict) else {}
        given = _value(value.strip())
        table[last] = [given] if ".".join(parts) in lists and isinstance(given, str) else given
    return found


def _value(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (tomllib.TOMLDecodeError, RecursionError, ValueError):
        return text
