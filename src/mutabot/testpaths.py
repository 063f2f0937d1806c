"""Find the tests that plain pytest runs in a project: ``testpaths`` in pytest's own configuration."""

from __future__ import annotations

import shlex
import tomllib
from contextlib import suppress
from glob import glob
from pathlib import Path
from typing import Any

import iniconfig

#: where pytest looks, the first that it takes counts: the file, its sections, and whether it is taken without
#: them (https://docs.pytest.org/en/stable/reference/customize.html)
_PLACES = (
    ("pytest.toml", ("pytest",), True),
    (".pytest.toml", ("pytest",), True),
    ("pytest.ini", ("pytest",), True),
    (".pytest.ini", ("pytest",), True),
    ("pyproject.toml", ("tool.pytest", "tool.pytest.ini_options"), False),
    ("tox.ini", ("pytest",), False),
    ("setup.cfg", ("tool:pytest",), False),
)


def test_paths(root: Path) -> tuple[str, ...]:
    """Return files and folders, relative to the root; none where nothing names them, or nothing is there."""
    names = _named(root)
    if not names or not all(isinstance(name, str) for name in names):
        return ()
    found: list[str] = []
    for name in names:
        there = (root / name).exists()
        # as pytest does it: ``Path.glob`` takes no absolute patterns
        found += [name] if there else sorted(glob(name, root_dir=root, recursive=True))  # noqa: PTH207
    return tuple(dict.fromkeys(found))


def _named(root: Path) -> list[Any]:
    for name, sections, is_taken_empty in _PLACES:
        tables = _sections(root / name, sections)
        value = next((table["testpaths"] for table in tables if "testpaths" in table), None)
        if isinstance(value, str):
            with suppress(ValueError):  # a quotation that is not closed; plain pytest reports it
                return shlex.split(value)
        if tables or (is_taken_empty and (root / name).is_file()):
            return value if isinstance(value, list) else []
    return []


def _sections(file: Path, names: tuple[str, ...]) -> list[Any]:
    """Return the sections that a file has; none if it cannot be read, which pytest reports."""
    try:
        if file.suffix != ".toml":
            read = iniconfig.IniConfig(str(file))
            return [dict(read[name].items()) for name in names if name in read]
        document: Any = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, iniconfig.ParseError):
        return []
    return [table for name in names if (table := _table(document, name))]


def _table(document: Any, name: str) -> Any:
    for part in name.split("."):
        document = document.get(part) if isinstance(document, dict) else None
    return document if isinstance(document, dict) else None
