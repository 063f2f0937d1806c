"""The extension by which mutabot finds this package's features."""

from __future__ import annotations

from mutabot.api.faults import Described, Extension

EXTENSION = Extension(
    interface=2,
    tables={
        "guard": "mutabot_hardware.tables:GuardTable",
        "hardware": "mutabot_hardware.tables:HardwareTable",
    },
    guards={
        "guard": "mutabot_hardware.guard:TableGuard",
        "hardware": "mutabot_hardware.command_guard:HardwareGuard",
    },
    executors={
        "hardware": Described(
            "mutabot_hardware.choice:HardwareChoice",
            "Run on the hardware of the configuration's table hardware: ask before each mutant, or yes to "
            "all; repeat allows motions that were stopped before.",
            "ask|yes|repeat",
        )
    },
)
