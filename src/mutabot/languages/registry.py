"""Which languages there are, and which one a file is written in."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from importlib import import_module
from pathlib import Path

from .front_end import FrontEnd
from .python import FRONT_END as PYTHON

_CONTRACT = ("__init__", "front_end", "registry", "python")


@cache
def front_ends() -> tuple[FrontEnd, ...]:
    """All of them; Python is the last, since the frames of an interpreter are Python's as well."""
    files = sorted(file.stem for file in Path(__file__).parent.glob("*.py"))
    others = (import_module(f"{__package__}.{name}") for name in files if name not in _CONTRACT)
    return (*(module.FRONT_END for module in others), PYTHON)


def front_end_of(file: str) -> FrontEnd:
    """That of a file's language, by how the file ends; files of no known language are taken for Python."""
    return next((one for one in front_ends() if file.endswith(one.suffixes)), PYTHON)


def program_files(root: Path, program: Iterable[str]) -> list[str]:
    """The program's files among the configured files and folders, relative to ``root``, each once."""
    suffixes = {suffix for one in front_ends() for suffix in one.suffixes}
    files: dict[str, None] = {}
    for name in program:
        path = root / name
        found = (
            {file for suffix in suffixes for file in path.rglob(f"*{suffix}")} if path.is_dir() else [path]
        )
        for file in sorted(found):
            files.setdefault(file.relative_to(root).as_posix())
    return list(files)
