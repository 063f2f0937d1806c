"""The hashes and descriptions of message types, as the packages bring them."""

from __future__ import annotations

import json
import os
import sys
from functools import cache
from pathlib import Path
from typing import Any


@cache
def _description(type_name: str) -> dict[str, Any] | None:
    package, folder, name = type_name.split("/")
    for share in _shares():
        file = share / package / folder / f"{name}.json"
        if file.is_file():
            found: dict[str, Any] = json.loads(file.read_text())
            return found
    return None


def _shares() -> list[Path]:
    prefixes = [prefix for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
    return [Path(prefix) / "share" for prefix in [*prefixes, sys.prefix]]


def hash_of(type_name: str) -> dict[str, Any]:
    """The hash of a type; zeros if its package does not tell."""
    found = _description(type_name)
    hashes = {entry["type_name"]: entry["hash_string"] for entry in found["type_hashes"]} if found else {}
    text = hashes.get(type_name)
    if text is None:
        return {"version": 0, "value": bytes(32)}
    return {"version": int(text[4:6]), "value": bytes.fromhex(text[7:])}
