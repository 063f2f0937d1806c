"""What this package brings to mutabot: its provider of faults in the program text, and its families."""

from __future__ import annotations

from mutabot.api.faults import Extension

PROVIDER = "source"

CONVENTIONAL = "conventional"
TEXT = "text"
BUGS = "bugs"
#: in the order of their numbers
OF_TEXT = (CONVENTIONAL, TEXT, BUGS)


EXTENSION = Extension(interface=2, faults={PROVIDER: "mutabot_source.provider:SourceFaults"})
