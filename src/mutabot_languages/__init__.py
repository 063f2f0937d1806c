"""Programs in URScript, RAPID and KRL: read without loss, run on a simulated cell, and mutated as text.

from mutabot_languages import load

def test_pick(cell):
    load("pick.script").run(cell)
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from .errors import LanguageError as LanguageError
from .errors import ProgramError as ProgramError
from .errors import UnsupportedError as UnsupportedError

if TYPE_CHECKING:
    from .loader import RobotProgram as RobotProgram
    from .loader import load as load

#: modules that need the cell: they are not loaded where only the list of features is wanted
_LAZY = ("RobotProgram", "load")

__all__ = ["LanguageError", "ProgramError", "UnsupportedError", *_LAZY]  # noqa: PLE0604


def __getattr__(name: str) -> object:
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(".loader", __name__), name)
    globals()[name] = value
    return value
