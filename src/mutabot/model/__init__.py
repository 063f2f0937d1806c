"""Plain data types of mutabot, without any input or output.

The names below are loaded when they are first used: a process below the tests needs few of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.model.call import Call, CallFault, Middleware, Proceed, Reply, Unchanged
    from mutabot.model.left_out import LeftOut
    from mutabot.model.mutant import Moment, Mutant, Role, Site, Span
    from mutabot.model.operation import ANY, Case, Clock, Operation, Pattern, Probe, Vocabulary, Wait
    from mutabot.model.outcome import By, Check, Compared, Kill, Looked, Outcome, Verdict
    from mutabot.model.path import Path
    from mutabot.model.program_text import (
        FATAL,
        IDENTITY,
        Alternative,
        Instrumentation,
        ProgramText,
        Sighting,
        TextPlace,
    )
    from mutabot.model.quantity import Kind, Mode, Quantity
    from mutabot.model.world_difference import Diverged

__all__ = [
    "ANY", "FATAL", "IDENTITY", "Alternative", "By", "Call", "CallFault", "Case", "Check",
    "Clock", "Compared", "Diverged", "Instrumentation", "Kill", "Kind", "LeftOut", "Looked", "Middleware",
    "Mode", "Moment", "Mutant", "Operation", "Outcome", "Path", "Pattern", "Probe",
    "Proceed", "ProgramText", "Quantity", "Reply", "Role", "Sighting", "Site", "Span", "TextPlace",
    "Unchanged", "Verdict", "Vocabulary", "Wait",
]  # fmt: skip
_HOMES = {
    "mutabot.model.path": ("Path",),
    "mutabot.model.quantity": ("Kind", "Mode", "Quantity"),
    "mutabot.model.call": ("Call", "Middleware", "CallFault", "Proceed", "Reply", "Unchanged"),
    "mutabot.model.mutant": ("Moment", "Mutant", "Role", "Site", "Span"),
    "mutabot.model.program_text": (
        "FATAL", "IDENTITY", "Alternative", "Instrumentation", "ProgramText", "Sighting", "TextPlace",
    ),
    "mutabot.model.operation": (
        "ANY", "Case", "Clock", "Operation", "Pattern", "Probe", "Vocabulary", "Wait",
    ),
    "mutabot.model.outcome": ("By", "Check", "Compared", "Kill", "Looked", "Outcome", "Verdict"),
    "mutabot.model.world_difference": ("Diverged",),
    "mutabot.model.left_out": ("LeftOut",),
}  # fmt: skip
__getattr__ = lazily(__name__, _HOMES)
