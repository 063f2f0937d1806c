"""How classes are named, in vocabularies, journals and messages alike."""

from __future__ import annotations

from typing import Any


def class_name(kind: type[Any]) -> str:
    """``module:Qualified.Name``."""
    return f"{kind.__module__}:{kind.__qualname__}"
