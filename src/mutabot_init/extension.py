"""What this package brings to mutabot."""

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
