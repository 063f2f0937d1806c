"""The interface for packages that bring faults: operators, providers and active faults."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.extensions import Described as Described
    from mutabot.extensions import Extension as Extension
    from mutabot.faults import FaultProvider as FaultProvider
    from mutabot.faults import Planned as Planned
    from mutabot.faults import PlannedMutant as PlannedMutant
    from mutabot.faults import Project as Project
    from mutabot.model.activation import Activation as Activation
    from mutabot.model.call import Unchanged as Unchanged
    from mutabot.model.mutant import Site as Site
    from mutabot.model.program_text import Alternative as Alternative
    from mutabot.model.program_text import ProgramText as ProgramText
    from mutabot.model.program_text import TextPlace as TextPlace
    from mutabot.operators.command import CommandOperator as CommandOperator
    from mutabot.operators.magnitudes import Magnitudes as Magnitudes
    from mutabot.operators.operator import Context as Context
    from mutabot.operators.operator import Example as Example
    from mutabot.operators.operator import Need as Need
    from mutabot.operators.operator import Rule as Rule
    from mutabot.operators.operator import Subject as Subject
    from mutabot.operators.value import ValueOperator as ValueOperator
    from mutabot.original import Original as Original
    from mutabot.runtime.active_fault import ActiveFault as ActiveFault

_HOMES = {
    "mutabot.extensions": ("Described", "Extension"),
    "mutabot.faults": ("FaultProvider", "Planned", "PlannedMutant", "Project"),
    "mutabot.model.activation": ("Activation",),
    "mutabot.model.call": ("Unchanged",),
    "mutabot.model.mutant": ("Site",),
    "mutabot.model.program_text": ("Alternative", "ProgramText", "TextPlace"),
    "mutabot.operators.command": ("CommandOperator",),
    "mutabot.operators.magnitudes": ("Magnitudes",),
    "mutabot.operators.operator": ("Context", "Example", "Need", "Rule", "Subject"),
    "mutabot.operators.value": ("ValueOperator",),
    "mutabot.original": ("Original",),
    "mutabot.runtime.active_fault": ("ActiveFault",),
}
__getattr__ = lazily(__name__, _HOMES)
