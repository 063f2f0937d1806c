"""The extension by which mutabot finds this package's features."""

from __future__ import annotations

from mutabot.api.faults import Described, Extension

EXTENSION = Extension(
    interface=2,
    commands={
        "motion": Described(
            "mutabot_motion.command:motion",
            "Show or film what one mutant did.",
        )
    },
)
