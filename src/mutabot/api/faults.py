"""What a package needs that brings faults: operators, providers and active faults."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.extensions import Described, Extension
    from mutabot.faults import FaultProvider, Planned, PlannedMutant, Project
    from mutabot.model.activation import Activation
    from mutabot.model.call import Unchanged
    from mutabot.model.mutant import Alternative, ProgramText, Site, TextPlace
    from mutabot.operators.command import CommandOperator
    from mutabot.operators.magnitudes import Magnitudes
    from mutabot.operators.operator import Context, Example, Need, Rule, Subject
    from mutabot.operators.value import ValueOperator
    from mutabot.original import Original
    from mutabot.runtime.active_fault import ActiveFault

__all__ = [
    "Activation",
    "ActiveFault",
    "Alternative",
    "CommandOperator",
    "Context",
    "Described",
    "Example",
    "Extension",
    "FaultProvider",
    "Magnitudes",
    "Need",
    "Original",
    "Planned",
    "PlannedMutant",
    "ProgramText",
    "Project",
    "Rule",
    "Site",
    "Subject",
    "TextPlace",
    "Unchanged",
    "ValueOperator",
]
_HOMES = {
    "mutabot.extensions": (
        "Described",
        "Extension",
    ),
    "mutabot.faults": (
        "FaultProvider",
        "Planned",
        "PlannedMutant",
        "Project",
    ),
    "mutabot.model.activation": ("Activation",),
    "mutabot.model.call": ("Unchanged",),
    "mutabot.model.mutant": (
        "Alternative",
        "ProgramText",
        "Site",
        "TextPlace",
    ),
    "mutabot.operators.command": ("CommandOperator",),
    "mutabot.operators.magnitudes": ("Magnitudes",),
    "mutabot.operators.operator": (
        "Context",
        "Example",
        "Need",
        "Rule",
        "Subject",
    ),
    "mutabot.operators.value": ("ValueOperator",),
    "mutabot.original": ("Original",),
    "mutabot.runtime.active_fault": ("ActiveFault",),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
