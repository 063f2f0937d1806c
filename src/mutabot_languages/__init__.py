"""Programs in URScript, RAPID and KRL: read without loss, run on a simulated cell, and mutated as text.

from mutabot_languages import load

def test_pick(cell):
    load("pick.script").run(cell)
"""

from __future__ import annotations

from .errors import LanguageError as LanguageError
from .errors import ProgramError as ProgramError
from .errors import UnsupportedError as UnsupportedError
from .loader import RobotProgram as RobotProgram
from .loader import load as load
