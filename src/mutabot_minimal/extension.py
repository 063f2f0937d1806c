"""The extension by which mutabot finds this package's features."""

from __future__ import annotations

from mutabot.api.faults import Described, Extension

EXTENSION = Extension(
    interface=2,
    commands={
        "minimal": Described(
            "mutabot_minimal.command:minimal",
            "Run every test on every mutant, and show a minimal set.",
            before="results",
        )
    },
    sections={"minimal": "mutabot_minimal.minimal:section"},
)
