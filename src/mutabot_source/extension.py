"""What this package brings to mutabot: its provider of faults in the program text, and its families."""

from __future__ import annotations

from mutabot.extensions import INTERFACE, Extension

PROVIDER = "source"

CONVENTIONAL = "conventional"
TEXT = "text"
#: in the order of their numbers
OF_TEXT = (CONVENTIONAL, TEXT)


EXTENSION = Extension(interface=INTERFACE, faults={PROVIDER: "mutabot_source.provider:SourceFaults"})
