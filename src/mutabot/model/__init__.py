"""Plain data: what mutabot talks about, without any input or output.

The names below are loaded when they are first used: a process below the tests needs few of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.model.call import Call as Call
    from mutabot.model.call import Middleware as Middleware
    from mutabot.model.call import Mishap as Mishap
    from mutabot.model.call import NotToldError as NotToldError
    from mutabot.model.call import Proceed as Proceed
    from mutabot.model.call import Reply as Reply
    from mutabot.model.mutant import FATAL as FATAL
    from mutabot.model.mutant import IDENTITY as IDENTITY
    from mutabot.model.mutant import Alternative as Alternative
    from mutabot.model.mutant import Choice as Choice
    from mutabot.model.mutant import Instrumentation as Instrumentation
    from mutabot.model.mutant import Moment as Moment
    from mutabot.model.mutant import Mutant as Mutant
    from mutabot.model.mutant import ProgramText as ProgramText
    from mutabot.model.mutant import Role as Role
    from mutabot.model.mutant import Sighting as Sighting
    from mutabot.model.mutant import Site as Site
    from mutabot.model.mutant import Span as Span
    from mutabot.model.mutant import TextPlace as TextPlace
    from mutabot.model.operation import ANY as ANY
    from mutabot.model.operation import Case as Case
    from mutabot.model.operation import Clock as Clock
    from mutabot.model.operation import Operation as Operation
    from mutabot.model.operation import Pattern as Pattern
    from mutabot.model.operation import Probe as Probe
    from mutabot.model.operation import Vocabulary as Vocabulary
    from mutabot.model.operation import Wait as Wait
    from mutabot.model.path import Path as Path
    from mutabot.model.quantity import Kind as Kind
    from mutabot.model.quantity import Mode as Mode
    from mutabot.model.quantity import Quantity as Quantity

    from .outcome import By as By
    from .outcome import Check as Check
    from .outcome import Compared as Compared
    from .outcome import Diverged as Diverged
    from .outcome import Kill as Kill
    from .outcome import LeftOut as LeftOut
    from .outcome import Looked as Looked
    from .outcome import Outcome as Outcome
    from .outcome import Verdict as Verdict

_HOMES = {
    "path": ("Path",),
    "quantity": ("Kind", "Mode", "Quantity"),
    "call": ("Call", "Middleware", "Mishap", "NotToldError", "Proceed", "Reply"),
    "mutant": (
        "FATAL", "IDENTITY", "Alternative", "Choice", "Instrumentation", "Moment", "Mutant", "ProgramText",
        "Role", "Sighting", "Site", "Span", "TextPlace",
    ),
    "operation": ("ANY", "Case", "Clock", "Operation", "Pattern", "Probe", "Vocabulary", "Wait"),
    "outcome": ("By", "Check", "Compared", "Diverged", "Kill", "LeftOut", "Looked", "Outcome", "Verdict"),
}  # fmt: skip
__getattr__, __dir__ = lazily(__name__, _HOMES)
