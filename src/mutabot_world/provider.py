"""Plans disturbances of the world: one mutant for each test, parameter, direction and magnitude."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from fnmatch import fnmatchcase

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
)  # fmt: skip

from .extension import FAMILY, PROVIDER
from .files import NO_PARAMETER, parameters_of
from .tables import ParameterTable, WorldTable
from .units import in_si, with_unit

ACTIVE = "mutabot_world.active:WorldFault"


class Disturb(Rule):
    """A parameter of the simulated world is other than it should be.

    Where: tests in which a simulated world is made.

    Stands for: A worn gripper, another payload, a fixture, a camera or a joint that stands off: what the
    published study leaves to future work as physical mutants.
    """

    name = "disturb"
    family = FAMILY
    has_sizes = True


class WorldFaults(FaultProvider):
    """Provides the disturbances of the simulated world."""

    name = PROVIDER
    families = (FAMILY,)
    location = "parameter"

    def rules(self) -> Sequence[Rule]:
        """Return the only operator, which is used for every parameter."""
        return [Disturb()]

    def texts(self, project: Project, first: int, notify: Callable[[str], None]) -> Sequence[ProgramText]:
        """Return nothing, but say how to see how disturbances end. Raises UsageError for wrong parameters."""
        if parameters_of(project.tables.get("world") or WorldTable(), project.root):
            notify("`mutabot world` shows which disturbances the tests notice, and which are suffered unseen")
        elif {*project.families} == {FAMILY}:  # others may have faults of this family
            notify(f"the table `world` has no parameter; {NO_PARAMETER}")
        return ()

    def is_monotone(self, operator: str) -> bool:
        """Return False: less friction may let a box slip into place where a little less lets it fall."""
        return False

    def at_magnitude(self, planned: PlannedMutant, magnitude: float) -> PlannedMutant:
        """Return the same disturbance with another magnitude."""
        made = super().at_magnitude(planned, magnitude)
        before, unit = planned.mutant.magnitude or 0.0, planned.mutant.unit
        text = planned.mutant.description.replace(with_unit(before, unit), with_unit(magnitude, unit), 1)
        data = {**planned.does, "amount": planned.does["amount"] * magnitude / before}
        active = replace(planned.active, data=data) if planned.active is not None else None
        return replace(made, mutant=replace(made.mutant, description=text), does=data, active=active)

    def plan(self, project: Project, original: Original) -> Planned:
        """Return a mutant for each test, parameter, direction and magnitude."""
        table = project.tables.get("world") or WorldTable()
        tests = dict.fromkeys(test for each in original.tests for test in each)
        planned = Planned()
        for parameter in parameters_of(table, project.root):
            for test in tests:
                if parameter.tests and not any(fnmatchcase(test, pattern) for pattern in parameter.tests):
                    continue
                reached = [
                    round
                    for round, each in enumerate(original.tests)
                    if test in each and _reaches(parameter, project, original.simulated(round, test))
                ]
                site = Site.of_parameter(test, parameter.name)
                planned.mutants += self._ladder(parameter, site, _why_not(parameter, project, reached))
                for round in reached:
                    planned.reach(round, site, [test])
        return planned

    def _ladder(self, parameter: ParameterTable, site: Site, reason: str | None) -> Iterator[PlannedMutant]:
        moment, unit = parameter.moment, parameter.measure
        key = Activation.at_time(moment.number) if moment.kind == "time" else Activation.EACH_TEST
        for way in parameter.ways:
            sign = {"+": "+", "-": "−"}.get(way, "")
            template = (parameter.less if way == "-" else parameter.more) or f"{parameter.name} {sign}{{}}"
            for size in parameter.ladder:
                text = f"{template.format(with_unit(size, unit))}{moment.text}"
                variant = f"{way}{size:g}{'%' if unit == 'percent' else unit or ''}"
                made = self.mutant(Disturb(), site, text, variant=variant, magnitude=size, unit=unit)
                data = _data(parameter, -size if way == "-" else size)
                active = Activation(ACTIVE, data, (key,), parameter.of[0].partition(":")[0], is_of_tests=True)
                yield PlannedMutant(replace(made, direction=way), reason, does=data, active=active)


def _data(parameter: ParameterTable, size: float) -> dict[str, object]:
    """Return the data that test processes need for the disturbance; paths take sizes as they are written."""
    is_written = parameter.path is not None and parameter.change != "scale"
    data = {name: getattr(parameter, name) for name in ("path", "apply", "names", "options", "change")}
    return {
        **data,
        "of": list(parameter.of),
        "amount": size if is_written else in_si(size, parameter.measure),
        "moment": asdict(parameter.moment),
    }


def _why_not(parameter: ParameterTable, project: Project, reached: Sequence[int]) -> str | None:
    if parameter.moment.kind == "time" and project.vocabulary.clock is None:
        return "the vocabulary names no clock"
    return None if reached else "the test simulates nothing, or not so long"


def _reaches(parameter: ParameterTable, project: Project, simulated: float) -> bool:
    """Return whether a test with this simulated duration, s, reaches the moment; at 0 it has no world."""
    if project.vocabulary.clock is None:
        return True
    moment = parameter.moment
    return simulated > 0.0 and (moment.kind != "time" or simulated >= moment.number)
