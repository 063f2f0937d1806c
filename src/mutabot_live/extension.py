"""What this package brings to mutabot."""

from __future__ import annotations

from mutabot.extensions import Described, Extension

EXTENSION = Extension(
    interface=1,
    commands={
        "live": Described(
            "mutabot_live.command:live",
            "Run the campaign and show its report in a browser while it fills, with a button to stop.",
        )
    },
)
