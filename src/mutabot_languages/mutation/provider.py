"""Plans mutants of the text of robot programs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from mutabot.api.faults import (
    Activation,
    FaultProvider,
    Original,
    Planned,
    PlannedMutant,
    ProgramText,
    Project,
    Rule,
    Site,
)
from mutabot_languages.edits import digest

from .differences import TextChange
from .planning import PlannedText, mutants_of, read_program
from .rewriting import Sizes
from .rules import BY_NAME, CONVENTIONAL, FAMILY, RULES

PROVIDER = "languages"
ACTIVE = "mutabot_languages.mutation.active:TextDifference"
#: what runs programs: a process is the mutant as soon as that is imported
_AWAITED = "mutabot_languages.loader"
_ORDER = (FAMILY, CONVENTIONAL)


class LanguageFaults(FaultProvider):
    """Mutants of the text of URScript, RAPID and KRL programs."""

    name = PROVIDER
    families = _ORDER
    location = "part of a program"
    in_program = True
    knows_reach = False  # which tests run a program, or look at a run, shows itself

    def __init__(self) -> None:
        self._root = Path()
        self._files: list[str] = []

    def rules(self) -> Sequence[Rule]:
        """Return all operators on these texts."""
        return RULES

    def is_monotone(self, operator: str) -> bool:
        """Return False: a point shifted far may be out of reach where a nearer one does harm unseen."""
        return False

    def texts(self, project: Project, first: int, notify: Callable[[str], None]) -> Sequence[ProgramText]:
        """Return nothing, as no Python text is needed, but report what cannot be read of the program."""
        read_program(project.root, project.program_files(), notify)
        return ()

    def plan(self, project: Project, original: Original) -> Planned:
        """Return the mutants of all files of the program that are of these languages."""
        self._root, self._files = project.root, project.program_files()
        planned = Planned()
        is_early = _is_run_early(original)
        sites: set[Site] = set()
        for program in read_program(project.root, self._files):
            for text in mutants_of(program):
                rule = BY_NAME[text.difference.operator]
                if not project.asks_for(rule):
                    continue
                planned.mutants.append(self._planned(rule, text, is_early=is_early))
                sites.add(text.site)
        for site in sorted(sites):
            for round, tests in enumerate(original.tests):
                planned.reach(round, site, tests)
        return planned

    def at_magnitude(self, planned: PlannedMutant, magnitude: float) -> PlannedMutant:
        """Return the same fault by another magnitude."""
        mutant = planned.mutant
        for program in read_program(self._root, self._files):
            if program.file != mutant.site.span.file:
                continue
            for text in mutants_of(program, Sizes.only(magnitude)):
                is_same = text.difference.operator == mutant.operator and text.site == mutant.site
                if is_same and text.difference.variant == mutant.variant.rstrip("0123456789.medg"):
                    is_early = planned.active is None or not planned.active.keys
                    return self._planned(BY_NAME[mutant.operator], text, is_early=is_early)
        return super().at_magnitude(planned, magnitude)

    def _planned(self, rule: Rule, text: PlannedText, *, is_early: bool) -> PlannedMutant:
        difference = text.difference
        size, variant = difference.magnitude, variant_of(difference)
        made = self.mutant(
            rule, text.site, text.description, variant=variant, magnitude=size, unit=difference.unit
        )
        if difference.magnitude is not None:
            made = replace(made, direction=difference.variant)
        data: dict[str, Any] = {
            "file": text.program.file,
            "digest": digest(text.program.content),
            "edits": [[edit.start, edit.end, edit.text] for edit in difference.edits],
        }
        # before any test nothing forks: a process of its own is the mutant from its beginning
        keys = () if is_early else (Activation.EACH_TEST,)
        active = Activation(ACTIVE, data, keys, awaits=_AWAITED)
        order = (_ORDER.index(rule.family),)
        # what changes elsewhere in the file does not change what it does
        at = difference.node.start
        does = [[edit.start - at, edit.end - at, edit.text] for edit in difference.edits]
        return PlannedMutant(made, difference.reason, order=order, does=does, active=active)


def _is_run_early(original: Original) -> bool:
    """Return whether a program of these languages has called the cell before any test."""
    from mutabot_languages.registry import language_for  # noqa: PLC0415

    return any(
        language_for(place.site.span.file) is not None and any(not hit.where[1] for hit in hits)
        for place, hits in original.hits.items()
    )


def variant_of(difference: TextChange) -> str:
    """Return the variant of its mutant."""
    if difference.magnitude is None:
        return difference.variant
    return f"{difference.variant}{difference.magnitude:g}{difference.unit}"
