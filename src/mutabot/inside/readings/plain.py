"""What the user's objects hold, as plain data that can be compared between processes."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

from mutabot.model.class_name import class_name

#: values within one value that are told; of more only whether they are all the same
LEAVES = 200
#: values within one value beyond which it is not looked at
MOST = 20_000
#: characters of a text that are told
_CHARACTERS = 300
_DEPTH = 20
_AS_TEXT = (complex, range, slice)
#: modules whose objects are told as texts; they are not imported for this
_TOLD = ("datetime", "decimal", "fractions")
#: what differs between equal runs in different processes
_ACCIDENTS = re.compile(r"0x[0-9a-fA-F]{6,}|pytest-\d+")


def plain(value: Any) -> Any:
    """The value as JSON-like data.

    What is no plain data becomes ``{"opaque": type}``, so that two of them are equal whatever they hold. A
    digest stands for what is large.
    """
    reader = _Reader()
    found = reader.read(value, 0)
    if reader.leaves > MOST:
        return opaque(value)
    if reader.leaves > LEAVES:
        return {"digest": _digest(json.dumps(found, sort_keys=True).encode())}
    return found


def text_of_error(error: BaseException) -> str:
    """An exception in words, without what differs between equal runs."""
    kind = class_name(type(error))
    return f"{kind.removeprefix('builtins:')}: {_ACCIDENTS.sub('…', str(error))[:_CHARACTERS]}"


class _Reader:
    def __init__(self) -> None:
        self.leaves = 0

    def read(self, value: Any, depth: int) -> Any:
        self.leaves += 1
        if value is None or isinstance(value, bool):
            return value
        if isinstance(value, Enum):
            return f"{type(value).__name__}.{value.name}"
        if isinstance(value, int | float):
            return float(value) if isinstance(value, float) else int(value)
        if isinstance(value, str | bytes | bytearray):
            return _text(value)
        if isinstance(value, _AS_TEXT) or type(value).__module__ in _TOLD:
            return repr(value)
        return opaque(value) if depth > _DEPTH or self.leaves > MOST else self._container(value, depth + 1)

    def _container(self, value: Any, depth: int) -> Any:
        if hasattr(value, "tolist") and hasattr(value, "dtype"):
            return self._array(value, depth)
        if hasattr(value, "_asdict"):
            value = value._asdict()
        elif is_dataclass(value) and not isinstance(value, type):
            value = {field.name: getattr(value, field.name, None) for field in fields(value)}
        if isinstance(value, Mapping):
            return {_key(key): self.read(item, depth) for key, item in value.items()}
        if isinstance(value, set | frozenset):
            value = sorted(value, key=repr)
        if isinstance(value, list | tuple):
            return [self.read(item, depth) for item in value]
        return opaque(value)

    def _array(self, value: Any, depth: int) -> Any:
        if value.dtype.hasobject:
            return opaque(value)
        if getattr(value, "size", 1) <= LEAVES:
            return self.read(value.tolist(), depth)
        return {"array": list(value.shape), "digest": _digest(value.tobytes())}


def _key(key: Any) -> str:
    return key if isinstance(key, str) else json.dumps(_Reader().read(key, 0))


def _text(value: str | bytes | bytearray) -> Any:
    if len(value) <= _CHARACTERS:
        return value if isinstance(value, str) else repr(bytes(value))
    return {"digest": _digest(value.encode("utf-8", "replace") if isinstance(value, str) else bytes(value))}


def opaque(value: Any) -> dict[str, str]:
    """What stands for a value that is no plain data."""
    return {"opaque": class_name(type(value))}


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]
