"""Plain data: what mutabot talks about, without any input or output.

The names below are loaded when they are first used: a process below the tests needs few of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.model.values.path import Path as Path
    from mutabot.model.values.quantity import Kind as Kind
    from mutabot.model.values.quantity import Mode as Mode
    from mutabot.model.values.quantity import Quantity as Quantity

    from .alternative import FATAL as FATAL
    from .alternative import IDENTITY as IDENTITY
    from .alternative import Alternative as Alternative
    from .alternative import Choice as Choice
    from .alternative import Instrumentation as Instrumentation
    from .alternative import ProgramText as ProgramText
    from .alternative import Sighting as Sighting
    from .alternative import TextPlace as TextPlace
    from .call import Call as Call
    from .call import Middleware as Middleware
    from .call import Mishap as Mishap
    from .call import NotToldError as NotToldError
    from .call import Proceed as Proceed
    from .call import Reply as Reply
    from .mutant import Moment as Moment
    from .mutant import Mutant as Mutant
    from .mutant import Role as Role
    from .mutant import Site as Site
    from .mutant import Span as Span
    from .operation import ANY as ANY
    from .operation import Case as Case
    from .operation import Clock as Clock
    from .operation import Operation as Operation
    from .operation import Pattern as Pattern
    from .operation import Probe as Probe
    from .operation import Vocabulary as Vocabulary
    from .operation import Wait as Wait
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
    "values.path": ("Path",),
    "values.quantity": ("Kind", "Mode", "Quantity"),
    "alternative": (
        "FATAL",
        "IDENTITY",
        "Alternative",
        "Choice",
        "Instrumentation",
        "ProgramText",
        "Sighting",
        "TextPlace",
    ),
    "call": ("Call", "Middleware", "Mishap", "NotToldError", "Proceed", "Reply"),
    "mutant": ("Moment", "Mutant", "Role", "Site", "Span"),
    "operation": ("ANY", "Case", "Clock", "Operation", "Pattern", "Probe", "Vocabulary", "Wait"),
    "outcome": ("By", "Check", "Compared", "Diverged", "Kill", "LeftOut", "Looked", "Outcome", "Verdict"),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
