"""The extension by which mutabot finds this package's provider and families of faults in program text."""

from __future__ import annotations

from mutabot.api.faults import Extension

PROVIDER = "source"

CONVENTIONAL = "conventional"
TEXT = "text"
BUGS = "bugs"
#: in the order of their numbers
OF_TEXT = (CONVENTIONAL, TEXT, BUGS)


EXTENSION = Extension(interface=2, faults={PROVIDER: "mutabot_source.provider:SourceFaults"})
