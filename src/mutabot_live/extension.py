"""The extension by which mutabot finds this package's features."""

from __future__ import annotations

from mutabot.api.faults import Described, Extension

EXTENSION = Extension(
    interface=2,
    commands={
        "live": Described(
            "mutabot_live.command:live",
            "Run the campaign with a page in a browser.",
        )
    },
)
