"""What this package brings."""

from __future__ import annotations

from mutabot.extensions import INTERFACE, Extension

from .families import PROVIDER

EXTENSION = Extension(interface=INTERFACE, faults={PROVIDER: "mutabot_source.provider:SourceFaults"})
