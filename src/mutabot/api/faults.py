"""What a package needs that brings faults: operators, providers and active faults."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.extensions import Described, Extension
    from mutabot.faults import FaultProvider, Planned, PlannedMutant, Preparation, Project
    from mutabot.model.activation import Activation
    from mutabot.model.mutant import Mutant, Site
    from mutabot.operators.operator import Example, Need, Operator, Rule, Subject
    from mutabot.original import Original
    from mutabot.runtime.active_fault import ActiveFault

__all__ = [
    "Activation",
    "ActiveFault",
    "Described",
    "Example",
    "Extension",
    "FaultProvider",
    "Mutant",
    "Need",
    "Operator",
    "Original",
    "Planned",
    "PlannedMutant",
    "Preparation",
    "Project",
    "Rule",
    "Site",
    "Subject",
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
        "Preparation",
        "Project",
    ),
    "mutabot.model.activation": ("Activation",),
    "mutabot.model.mutant": (
        "Mutant",
        "Site",
    ),
    "mutabot.operators.operator": (
        "Example",
        "Need",
        "Operator",
        "Rule",
        "Subject",
    ),
    "mutabot.original": ("Original",),
    "mutabot.runtime.active_fault": ("ActiveFault",),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
