"""What measured comparisons say for and against the published claim, by rule.

The claim: conventional operators suit robot programs badly, because they find too few places, break commands
as text, ask for physically impossible motions, or make no difference. Each part is held against the robot
family on the same program. A rule never looks at which program or family it is.

For counts of places the larger one decides. For shares the 95 % interval of the difference decides: *for*
the claim if it lies wholly above zero, *against* it if wholly below, *undecided* otherwise. It is made from
the two shares' own intervals as Newcombe does ("Interval estimation for the difference between independent
proportions", Statistics in Medicine 17, 1998, method 10; Zou and Donner, Statistics in Medicine 27, 2008,
for intervals other than Wilson's). Both families share the rounds, which draws them together rather than
apart: where rounds matter, the interval is wider than need be.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

#: one family of a comparison, and a whole comparison, as docs/compare.md describes them
Family = Mapping[str, Any]
Data = Mapping[str, Any]
ROBOT, CONVENTIONAL = "robot", ("conventional", "text")


class Stance(StrEnum):
    """What a number says of a claim."""

    FOR = "for"
    AGAINST = "against"
    UNDECIDED = "undecided"
    UNKNOWN = "not measured"


@dataclass(frozen=True, slots=True)
class Finding:
    """What one family on one program says of a claim."""

    stance: Stance
    sentence: str


@dataclass(frozen=True, slots=True)
class Claim:
    """One part of the claim.

    Attributes:
        name: a few words.
        statement: what is claimed.
        judge: what a conventional family says of it, beside the robot family.
        of_outcomes: whether it speaks of outcomes, so that a family without mutants says nothing.
    """

    name: str
    statement: str
    judge: Callable[[Data, Family, Family], Finding]
    of_outcomes: bool = True


def family_of(data: Data, name: str, role: str = "program") -> Family | None:
    """A family in a role, if it was asked for."""
    for family in data["families"]:
        if (family["family"], family["role"]) == (name, role):
            return dict(family)
    return None


def finding(claim: Claim, data: Data, name: str) -> Finding:
    """What a family says of a claim on one program."""
    robot, other = family_of(data, ROBOT), family_of(data, name)
    if robot is None or other is None:
        return Finding(Stance.UNKNOWN, f"the {name if robot is not None else ROBOT} family was not run")
    for family in (robot, other):
        if not family["done"] and (claim.of_outcomes or family is robot):
            return Finding(Stance.UNKNOWN, f"there is no {family['family']} mutant")
    return claim.judge(data, robot, other)


def difference(left: Mapping[str, Any], right: Mapping[str, Any]) -> tuple[float, float, float] | None:
    """One share less another, with the ends of its interval; None where either has no interval."""
    if left["interval"] is None or right["interval"] is None:
        return None
    first, second = left["share"], right["share"]
    below = math.hypot(first - left["interval"]["low"], right["interval"]["high"] - second)
    above = math.hypot(left["interval"]["high"] - first, second - right["interval"]["low"])
    return first - second, first - second - below, first - second + above


def decide(first: Mapping[str, Any], second: Mapping[str, Any]) -> Stance:
    """For if one share is clearly above the other, against if clearly below."""
    found = difference(first, second)
    if found is None:
        return Stance.UNDECIDED
    _, low, high = found
    if low > 0:
        return Stance.FOR
    return Stance.AGAINST if high < 0 else Stance.UNDECIDED


def difference_text(first: Mapping[str, Any], second: Mapping[str, Any]) -> str:
    """``+17.0 (3.0 to 25.0)``, in percentage points."""
    found = difference(first, second)
    if found is None:
        return "nothing tells how sure the difference is"
    middle, low, high = (f"{100 * number:.1f}".replace("-", "−") for number in found)
    return f"{'' if middle.startswith('−') else '+'}{middle} ({low} to {high})"


def share_text(share: Mapping[str, Any]) -> str:
    """``42/120, 35 % (28–44)``."""
    counts = f"{share['count']}/{share['of']}"
    if share["share"] is None:
        return f"at least {counts}" if share.get("unknown") else counts
    interval = share["interval"]
    between = f" ({100 * interval['low']:.0f}–{100 * interval['high']:.0f})" if interval else ""
    return f"{counts}, {percent(share['share'])}{between}"


def percent(share: float | None) -> str:
    """``35 %``, ``8.9 %``, or ``–``."""
    if share is None:
        return "–"
    return f"{100 * share:.1f} %" if 0 < share < 0.0995 else f"{100 * share:.0f} %"


def _places(data: Data, robot: Family, other: Family) -> Finding:
    if data["sample"] is not None:
        return Finding(Stance.UNKNOWN, "a sample of the mutants does not tell how many places there are")
    ours = f"robot {robot['mutants']} at {robot['places']}"
    sentence = f"{other['mutants']} mutants at {other['places']} places, {ours}"
    if other["places"] == robot["places"]:
        return Finding(Stance.UNDECIDED, sentence)
    return Finding(Stance.FOR if other["places"] < robot["places"] else Stance.AGAINST, sentence)


def _weakness(key: str) -> Callable[[Data, Family, Family], Finding]:
    def judge(data: Data, robot: Family, other: Family) -> Finding:
        conventional, ours = other["weaknesses"][key], robot["weaknesses"][key]
        return Finding(decide(conventional, ours), _beside(conventional, ours))

    return judge


def _uninformative(data: Data, robot: Family, other: Family) -> Finding:
    conventional, ours = other["informative"], robot["informative"]
    return Finding(decide(ours, conventional), _beside(conventional, ours))


def _beside(share: Mapping[str, Any], ours: Mapping[str, Any]) -> str:
    """Two shares and their difference in words."""
    told = (f"{mapping['count']}/{mapping['of']}" for mapping in (share, ours))
    return f"{', robot '.join(told)}: {difference_text(share, ours)}"


CLAIMS: Sequence[Claim] = (
    Claim(
        "too few places",
        "Fewer places than the robot family's.",
        _places,
        of_outcomes=False,
    ),
    Claim(
        "broken commands",
        "Invalid, or raising before any command reaches the robot.",
        _weakness("broken"),
    ),
    Claim(
        "impossible motions",
        "The robot refuses what they ask for.",
        _weakness("impossible"),
    ),
    Claim(
        "no difference",
        "Nothing compared differs.",
        _weakness("no_difference"),
    ),
    Claim(
        "any of the three",
        "Invalid, infeasible or equivalent.",
        _weakness("any"),
    ),
    Claim(
        "uninformative",
        "Fewer are valid, not trivial and not indistinguishable.",
        _uninformative,
    ),
)
