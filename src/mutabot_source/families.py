"""The provider of faults in the program text, and its families: their names, said once."""

from __future__ import annotations

PROVIDER = "source"

CLASSICAL = "classical"
TEXT = "text"
#: in the order of their numbers
OF_TEXT = (CLASSICAL, TEXT)
