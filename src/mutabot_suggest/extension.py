"""The extension by which mutabot finds this package's features."""

from __future__ import annotations

from mutabot.api.faults import Described, Extension

EXTENSION = Extension(
    interface=2,
    commands={
        "suggest": Described(
            "mutabot_suggest.command:suggest",
            "Suggest checks that kill survivors.",
            before="results",
        )
    },
)
