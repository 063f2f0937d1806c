"""The results of ``mutabot suggest`` as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mutabot.api.reports import MutabotError


class NothingToSuggestError(MutabotError):
    """Raised if no survivor can have a check suggested, or no test can have one added."""

    exit_code = 3


@dataclass(frozen=True, slots=True)
class ProvenCheck:
    """One proven check.

    Attributes:
        test: node id of the test that it is added to, without parameters.
        style: ``pytest``, ``unittest``, or ``other`` for a test that another tool makes.
        looks_at: the expression that it reads.
        statement: the assertion.
        tolerance: how far the reading may be off, in its unit; None where it must be equal.
        spread: how far runs of the original are apart; None where they must be equal.
        runs: runs of the original that were measured.
        fresh: fresh seeds in which it was run on the original afterwards; it passed in all.
        unseen: share of runs in which it may fail although it did not in these, with 95 % confidence.
        kills: id of each mutant that it kills by itself, to the 0-based rounds in which it does.
        after: the name of the object behind whose making it stands; empty for the end of the test.
        by_hand: all that is to be added where no diff can: to a test that another tool makes; else empty.
    """

    test: str
    style: str
    looks_at: str
    statement: str
    tolerance: float | None
    spread: float | None
    runs: int
    fresh: int
    unseen: float
    kills: Mapping[str, tuple[int, ...]]
    after: str = ""
    by_hand: str = ""


@dataclass(frozen=True, slots=True)
class Unsolved:
    """A survivor that no check kills.

    Attributes:
        mutant: its id.
        reason: why not.
        never: whether no check was searched for, as nothing that was compared differs, or no test reaches it.
    """

    mutant: str
    reason: str
    never: bool = False


@dataclass(frozen=True, slots=True)
class Dropped:
    """A check that failed its proof.

    Attributes:
        test: the test that it was added to.
        statement: the assertion.
        reason: how it failed.
    """

    test: str
    statement: str
    reason: str


@dataclass(frozen=True, slots=True)
class Suggestions:
    """The results of ``mutabot suggest``.

    Attributes:
        checks: those first that kill most.
        diff: all of them as one unified diff of the project.
        unsolved: survivors that none of them kills.
        dropped: checks that failed their proof.
        numbers: number of each survivor by its id.
        descriptions: what each survivor does, by its id.
        rounds: rounds of the campaign.
        seeds: fresh seeds that were run to find values and tolerances, and as many others for the proof.
    """

    checks: tuple[ProvenCheck, ...] = ()
    diff: str = ""
    unsolved: tuple[Unsolved, ...] = ()
    dropped: tuple[Dropped, ...] = ()
    numbers: Mapping[str, int] = field(default_factory=dict)
    descriptions: Mapping[str, str] = field(default_factory=dict)
    rounds: int = 0
    seeds: int = 0
