"""Reads the parameters of a project: those in its configuration, and those in separate files."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator
from fnmatch import fnmatchcase
from importlib.util import find_spec
from pathlib import Path

from pydantic import ValidationError

from mutabot.api.reports import UsageError

from .tables import ParameterFile, ParameterTable, WorldTable

#: what to do where a project has no parameters
NO_PARAMETER = '`mutabot init` proposes some, and files have some: parameters = ["mutabot_world:mujoco.toml"]'


def parameters_of(table: WorldTable, root: Path) -> list[ParameterTable]:
    """Return the parameters of a configuration; those from files come first.

    Raises UsageError for a file that cannot be read, for two parameters of one name, and for a name that is
    to be taken and is none.
    """
    found = [found_table for name in table.parameters for found_table in _of_file(name, root)]
    kept = [
        found_table
        for found_table in found
        if not table.only or any(fnmatchcase(found_table.name, p) for p in table.only)
    ]
    unused = [
        pattern for pattern in table.only if not any(fnmatchcase(other.name, pattern) for other in found)
    ]
    if unused:
        known = ", ".join(found_table.name for found_table in found) or "there are none"
        raise UsageError(f"world.only: no parameter is named {unused[0]!r}; the files have: {known}")
    stray = next((name for name in table.names if name not in [other.name for other in kept]), None)
    if stray is not None:
        raise UsageError(f"world.names: no parameter of the files is named {stray!r}")
    kept = [
        kept_table.model_copy(update={"names": table.names[kept_table.name]})
        if kept_table.name in table.names
        else kept_table
        for kept_table in kept
    ]
    kept += _with_maker(table.parameter, table.of, "the configuration")
    names = [kept_table.name for kept_table in kept]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise UsageError(f"two parameters of the world are named {twice!r}")
    return kept


def _of_file(name: str, root: Path) -> Iterator[ParameterTable]:
    path = _path(name, root)
    try:
        read = ParameterFile.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise UsageError(f"world.parameters: {name} cannot be read: {error.strerror or error}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"world.parameters: {name} is not valid TOML: {error}") from None
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(str(part + 1 if isinstance(part, int) else part) for part in first["loc"])
        raise UsageError(f"{name}: {place}: {first['msg']}") from None
    if ":" in name and read.of and find_spec(library := re.split(r"[.:]", read.of[0])[0]) is None:
        raise UsageError(f"world.parameters: {name} disturbs worlds of {library!r}, which is not installed")
    return _with_maker(read.parameter, read.of, name)


def _with_maker(
    found: Iterable[ParameterTable], makers: tuple[str, ...], where: str
) -> Iterator[ParameterTable]:
    for table in found:
        if not (table.of or makers):
            does_not = f"parameter {table.name!r} does not say what makes its world"
            raise UsageError(f'{where}: {does_not}: of = ["module:Class"]')
        yield table if table.of else table.model_copy(update={"of": makers})


def _path(name: str, root: Path) -> Path:
    """Return the path of a parameter file: in the project, or ``package:file`` of an installed package."""
    package, is_shipped, file = name.partition(":")
    if not is_shipped:
        return root / name
    try:
        spec = find_spec(package)
    except (ImportError, ValueError):
        spec = None
    for folder in (spec.submodule_search_locations or ()) if spec is not None else ():
        if (found := Path(folder, file)).is_file():
            return found
    raise UsageError(f"world.parameters: there is no file {file!r} in a package {package!r}")
