"""Formats by name: files in ``formats/``, and those that packages bring. Only the one asked for is loaded."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Mapping

from mutabot.errors import ExtensionError, UsageError, unknown_name_text
from mutabot.extensions import Part, brought

from . import formats
from .format import Format


def names() -> list[str]:
    """The names of all formats."""
    return sorted([*_own(), *_of_packages()])


def format_of(name: str) -> Format:
    """The format of this name. Raises UsageError, with the nearest name, if there is none."""
    if name in _own():
        module = importlib.import_module(f"{formats.__name__}.{name.replace('-', '_')}")
        found: Format = module.FORMAT
        return found
    part = _of_packages().get(name)
    if part is None:
        raise UsageError(unknown_name_text("format", name, names()))
    loaded = part.load()
    if not isinstance(loaded, Format):
        raise ExtensionError(f"{part.words} is no {Format.__module__}.Format")
    return loaded


def _own() -> list[str]:
    found = (module.name for module in pkgutil.iter_modules(formats.__path__))
    return [name.replace("_", "-") for name in found if not name.startswith("_")]


def _of_packages() -> Mapping[str, Part]:
    return brought("formats", _own())
