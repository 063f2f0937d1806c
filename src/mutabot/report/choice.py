"""Formats by name: each is a file in ``formats/``, and only the one that is asked for is loaded."""

from __future__ import annotations

import importlib
import pkgutil

from mutabot.errors import UsageError, unknown_name_text

from . import formats
from .format import Format


def names() -> list[str]:
    """The names of all formats."""
    found = (module.name for module in pkgutil.iter_modules(formats.__path__))
    return sorted(name.replace("_", "-") for name in found if not name.startswith("_"))


def format_of(name: str) -> Format:
    """The format of this name. Raises UsageError, with the nearest name, if there is none."""
    if name not in names():
        raise UsageError(unknown_name_text("format", name, names()))
    module = importlib.import_module(f"{formats.__name__}.{name.replace('-', '_')}")
    found: Format = module.FORMAT
    return found
