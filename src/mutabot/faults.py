"""Providers of faults: where they can act, and how they become active in a process.

A provider has two halves. The one here works in the controller: it says what it needs of the baseline, and
makes the mutants of it. The other lives in the processes of the tests: a
``mutabot.runtime.active_fault.ActiveFault``, which ``PlannedMutant.active`` names. The core has two of these:
one changes intercepted calls (``mutabot/runtime/interception``), one switches alternatives in the text of the
program (``mutabot/runtime/program_text``). Packages bring any other.

A package names its provider under ``faults`` of its ``Extension`` (``mutabot/extensions.py``). Nothing that a
campaign without its mutants has no use for is to be imported with it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from mutabot.errors import UsageError, unknown_name_text
from mutabot.extensions import brought, not_installed
from mutabot.families import OF_CALLS
from mutabot.frozen import frozen
from mutabot.languages.python import FRONT_END as PYTHON
from mutabot.languages.registry import front_end_of, program_files
from mutabot.model import LeftOut, Moment, Mutant, ProgramText, Site, TextPlace, Vocabulary
from mutabot.model.activation import Activation
from mutabot.model.codec import to_data
from mutabot.model.mutant import Place
from mutabot.thresholds.demands import Demand
from mutabot.thresholds.planned import at_magnitude

if TYPE_CHECKING:
    from mutabot.operators.operator import Rule
    from mutabot.original import Original


@frozen
class Project:
    """The project, and the mutants that providers are asked for.

    Attributes:
        root: its folder.
        program: files and folders of the program, relative to it.
        vocabulary: the robot API; empty if none is needed.
        families: the families that are asked for.
        moments: at which of its calls a mutant of calls acts, a mutant each; None for every call.
        demands: of which magnitudes users speak: these are planted, whatever the families.
        tables: the tables of packages that the configuration has, by name: each an object of the class that
            the package names under ``tables`` of its ``Extension``.
    """

    root: Path = Path()
    program: tuple[str, ...] = ()
    vocabulary: Vocabulary = field(default_factory=Vocabulary)
    families: tuple[str, ...] = ()
    moments: tuple[Moment | None, ...] = (None,)
    demands: tuple[Demand, ...] = ()
    tables: Mapping[str, Any] = field(default_factory=dict)

    def asks_for(self, rule: Rule) -> bool:
        """Return whether mutants of an operator are asked for, by its family or by a demanded magnitude."""
        is_demanded = rule.has_sizes and any(demand.operator == rule.name for demand in self.demands)
        return rule.family in self.families or is_demanded

    def program_files(self) -> list[str]:
        """Return the files of the program, in all its languages, relative to ``root``, each once."""
        return program_files(self.root, self.program)

    def is_python(self, file: str) -> bool:
        """Return whether a file of the program is Python, as it has no suffix of another language."""
        return front_end_of(file) is PYTHON


@frozen
class PlannedMutant:
    """A mutant plus data that only the controller needs.

    Attributes:
        mutant: the mutant; it gets its number later.
        reason: why it is left out; None if it is planted.
        order: which comes first among the mutants of its provider, and of those that are numbered with it;
            what is equal keeps its order.
        does: what it does beyond what its id says, as plain data: its outcomes depend on it.
        active: how it becomes active in the processes of the tests; None for one that is left out.
    """

    mutant: Mutant
    reason: str | None = None
    order: tuple[int, ...] = ()
    does: Any = None
    active: Activation | None = None

    @classmethod
    def of_text(
        cls, provider: str, place: TextPlace, index: int, description: str, reason: str | None = None
    ) -> PlannedMutant:
        """Return a mutant of the program text: the alternative with this index at a place.

        Args:
            provider: name of the provider that makes it.
            place: the place; its number is that of ``Original.texts``.
            index: of the alternative among those of the place, from 0.
            description: one line that an engineer recognises.
            reason: why it is left out; None if it is planted.
        """
        fault = place.alternatives[index]
        mutant = Mutant(
            0, fault.family, fault.operator, place.site, "", None, None, fault.variant, description,
            provider=provider,
        )  # fmt: skip
        return cls(mutant, reason, does=to_data(fault), active=Activation.of_text(place.number, index))

    @property
    def as_left_out(self) -> LeftOut:
        """Its entry in the plan's list of mutants that are left out."""
        return LeftOut(self.mutant.id, self.mutant.description, self.reason or "")


@dataclass(slots=True)
class Planned:
    """What a provider has planned for a baseline.

    Attributes:
        mutants: those it plants, and those it leaves out with the reason.
        texts: the program text with the alternatives that can run.
        reached: (round, place) to the tests that reach it, see ``reach``. Calls and places of the program
            text are observed.
        below: (round, place, test) to the origins of the processes below the tests in which that is.
        early: places that are reached before any test, or while a module is imported: what stands there holds
            for a whole process, and all tests judge it.
    """

    mutants: list[PlannedMutant] = field(default_factory=list)
    texts: tuple[ProgramText, ...] = ()
    reached: dict[tuple[int, Place], tuple[str, ...]] = field(default_factory=dict)
    below: dict[tuple[int, Place, str], set[str]] = field(default_factory=dict)
    early: set[Place] = field(default_factory=set)

    def reach(self, round: int, site: Site, tests: Iterable[str]) -> None:
        """Note which tests reach a site in a round: only these judge the mutants there.

        Args:
            round: from 0.
            site: one of ``mutants``.
            tests: node ids, of ``Original.tests``.
        """
        self._reach(round, Place(site, ""), tests)

    def reach_text(self, original: Original) -> None:
        """Note which tests reach the places in ``texts``."""
        places = {place.number: place for text in self.texts for place in text.places}
        for round, seen in sorted(original.text.items()) if places else ():
            for origin, found in (("", seen.reached), *seen.below.items()):
                reaching: dict[int, list[str]] = {}  # the tests by place: a suite may have ten thousand
                for test, number in ((test, count) for test, numbers in found.items() for count in numbers):
                    reaching.setdefault(number, []).append(test)
                for number, tests in reaching.items():
                    if number in places:
                        self._reach_place(round, places[number], origin, tests)

    def _reach(self, round: int, place: Place, tests: Iterable[str]) -> None:
        self.reached[round, place] = tuple(dict.fromkeys((*self.reached.get((round, place), ()), *tests)))

    def _reach_place(self, round: int, found: TextPlace, origin: str, tests: list[str]) -> None:
        place = Place(found.site, "")
        self._reach(round, place, tests)
        for test in tests if origin else ():
            self.below.setdefault((round, place, test), set()).add(origin)
        # what a process below the tests evaluates holds for that process alone
        if (found.at_import and not origin) or "" in tests:
            self.early.add(place)


class FaultProvider(ABC):
    """The base class of providers of faults, which make mutants.

    Class attributes:
        name: how its mutants name it.
        families: the families of its mutants, in the order in which they are listed.
        location: what a place of its own is called in messages.
        needs_vocabulary: whether its mutants need a vocabulary.
        in_program: whether all its mutants stand in files of the program or the oracle: words of ``--only``
            that name no such file are then refused before the baseline is taken.
        numbered_with: name of the provider with whose mutants its own are put in one order; empty for none.
        knows_reach: whether ``plan`` says which tests reach a mutant. If not, it says all of them, and a
            mutant of which no test reports a hit is not covered.
    """

    name: ClassVar[str]
    families: ClassVar[tuple[str, ...]]
    location: ClassVar[str] = "location"
    needs_vocabulary: ClassVar[bool] = False
    in_program: ClassVar[bool] = False
    numbered_with: ClassVar[str] = ""
    knows_reach: ClassVar[bool] = True

    def is_asked_for(self, project: Project) -> bool:
        """Return whether any of its mutants are asked for."""
        is_of_family = not set(self.families).isdisjoint(project.families)
        return is_of_family or any(project.asks_for(rule) for rule in self.rules())

    def rules(self) -> Sequence[Rule]:
        """Return its operators, for lists, documentation and reports."""
        return ()

    def mutant(
        self,
        rule: Rule,
        site: Site,
        description: str,
        *,
        variant: str = "",
        magnitude: float | None = None,
        unit: str | None = None,
    ) -> Mutant:
        """Return a mutant of this provider, whose site is no call of an operation.

        Args:
            rule: the operator that makes it.
            site: where it acts.
            description: one line that an engineer recognises.
            variant: which of several mutants of the operator here; empty if there is only one.
            magnitude: how big its fault is, in ``unit``; None for a fault without a size.
            unit: of the magnitude; None where it has none.
        """
        return Mutant(
            0, rule.family, rule.name, site, "", None, None, variant, description,
            magnitude=magnitude, unit=unit, has_sizes=rule.has_sizes, provider=self.name,
        )  # fmt: skip

    def texts(self, project: Project, first: int, notify: Callable[[str], None]) -> Sequence[ProgramText]:
        """Return the program text that the baseline's first run of each round has to instrument.

        Args:
            project: the project.
            first: the number of the first place in the texts; each has the next one.
            notify: shows a message to the user.
        """
        return ()

    @abstractmethod
    def plan(self, project: Project, original: Original) -> Planned:
        """Return all its mutants of the families that are asked for.

        Each once, and of a fault with sizes its usual ones: the plan adds moments and magnitudes that users
        ask for, where ``Rule.has_moments`` and ``Rule.has_sizes`` of the operator say so.

        Args:
            project: the project.
            original: what the baseline has seen; its ``texts`` has those of this provider, by its name.
        """

    def at_magnitude(self, planned: PlannedMutant, magnitude: float) -> PlannedMutant:
        """Return the same fault at another magnitude, which users demand.

        Unless a provider says otherwise, the fault takes its size from ``Mutant.magnitude``: else nothing
        differs but the mutant's variant and description, which have it as ``f"{magnitude:g}"``.
        """
        return replace(planned, mutant=at_magnitude(planned.mutant, magnitude))

    def draws(self, operator: str) -> bool:
        """Return whether one of its operators draws new random numbers in each round."""
        return False

    def is_raced(self, operator: str) -> bool:
        """Return whether equal runs with a fault of this operator may end differently."""
        return False

    def is_monotone(self, operator: str) -> bool:
        """Return whether tests that notice a fault also notice all larger ones; if not, each one is run."""
        return True


@cache
def brought_providers() -> tuple[FaultProvider, ...]:
    """Return the fault providers of packages. Raises ExtensionError if a provider cannot be loaded."""
    return tuple(part.make(FaultProvider) for part in brought("faults").values())  # type: ignore[type-abstract]


def families_brought(*, without_vocabulary: bool = False) -> tuple[str, ...]:
    """Return the families of the packages' providers, or of those that need no vocabulary."""
    return tuple(
        dict.fromkeys(
            family
            for provider in brought_providers()
            if not (without_vocabulary and provider.needs_vocabulary)
            for family in provider.families
        )
    )


def need_vocabulary(families: Iterable[str]) -> bool:
    """Return whether mutants of any of these families need a vocabulary."""
    asked = set(families)
    return not asked.isdisjoint(OF_CALLS) or not asked <= set(families_brought(without_vocabulary=True))


def why_unknown(name: str) -> str | None:
    """Return why there is no family of this name, with the nearest name; None if there is one."""
    if name in OF_CALLS:
        why = not_installed(name, "operators")
        return why and f"the family {name} {why}"
    if name in families_brought() or name in known_families():
        return None
    return unknown_name_text("family", name, known_families())


def asked_for(names: Iterable[str]) -> tuple[str, ...]:
    """Return the families, each once, in the order of their mutants' numbers.

    Raises UsageError for a name that is none.
    """
    names = list(names)
    for name in names:
        why = why_unknown(name)
        if why is not None:
            raise UsageError(why)
    known = OF_CALLS if set(names) <= set(OF_CALLS) else known_families()
    return tuple(family for family in known if family in names)


def known_families() -> tuple[str, ...]:
    """Return all known families. Raises OperatorError or ExtensionError for an invalid package."""
    from mutabot.operators import load_all  # noqa: PLC0415  # most campaigns ask for mutabot's own

    of_operators = (rule.family for rule in load_all())
    return tuple(dict.fromkeys((*OF_CALLS, *of_operators, *families_brought())))
