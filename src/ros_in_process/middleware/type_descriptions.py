"""The hashes and descriptions of message types, as their packages provide them."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

from ros_in_process.middleware.messages import class_of


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


def _hash_text(type_name: str) -> str:
    found = _description(type_name)
    hashes = {entry["type_name"]: entry["hash_string"] for entry in found["type_hashes"]} if found else {}
    return str(hashes.get(type_name, ""))


def hash_of(type_name: str) -> dict[str, Any]:
    """Return the hash of a type; zeros if its package does not provide one."""
    text = _hash_text(type_name)
    if not text:
        return {"version": 0, "value": bytes(32)}
    return {"version": int(text[4:6]), "value": bytes.fromhex(text[7:])}


def answer_about(request: Any, response: Any, types: Iterable[str]) -> Any:
    """Fill in the response of a node's `get_type_description` service; the hash identifies the type."""
    meant = [name for name in types if _hash_text(name) == request.type_hash]
    found = _description(meant[0] if meant else request.type_name)
    if found is None:
        response.failure_reason = "type not currently in use by this node"
        return response
    _fill(response.type_description, found["type_description_msg"])
    response.successful = True
    return response


def _fill(message: Any, values: dict[str, Any]) -> None:
    for name, value in values.items():
        if isinstance(value, dict):
            _fill(getattr(message, name), value)
        elif isinstance(value, list):
            kind = dict(zip(message.__slots__, message.SLOT_TYPES, strict=False))[f"_{name}"].value_type
            for inner in value:
                getattr(message, name).append(_made(kind, inner))
        else:
            setattr(message, name, value)


def _made(kind: Any, values: dict[str, Any]) -> Any:
    made = class_of(kind)()
    _fill(made, values)
    return made
