"""The extension by which mutabot finds this package's features."""

from __future__ import annotations

from mutabot.api.faults import Described, Extension

EXTENSION = Extension(
    interface=2,
    commands={
        "init": Described(
            "mutabot_init.command:init",
            "Draft a configuration and a vocabulary.",
            before="check",
        )
    },
)
