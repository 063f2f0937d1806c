"""The extension by which mutabot finds this package's features."""

from __future__ import annotations

from mutabot.api.faults import Described, Extension

PROVIDER, FAMILY, TABLE = "patches", "patch", "patches"

EXTENSION = Extension(
    interface=2,
    faults={PROVIDER: "mutabot_patches.provider:PatchFaults"},
    tables={TABLE: "mutabot_patches.tables:PatchesTable"},
    commands={
        "patches": Described(
            "mutabot_patches.command:patches",
            "Write reverted fixes of the history as patches.",
            before="run",
        )
    },
)
