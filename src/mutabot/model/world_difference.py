"""How far a mutant led from the original, by recordings of the world."""

from __future__ import annotations

from typing import Any

from mutabot.frozen import frozen
from mutabot.model.deviation import deviation_of

#: What a turn on the way counts, as a part of one that remains: turning about its own axis, a thing needs
#: hardly more room than its own width, and nothing is left that is wrong. Chosen by hand-made orders of the
#: survivors of three examples.
TURN_ON_THE_WAY = 0.1


@frozen
class Apart:
    """The distance of one object from its position in the original at the same time.

    Attributes:
        name: which thing, such as ``box``; ``box turned`` for its orientation.
        unit: of the numbers: m, deg, or that of a value.
        first: when it was apart first by more than the tolerance, s.
        largest: greatest difference, and ``at`` when, s.
        final: difference at the end.
        aside: of a position, the greatest distance from the path of the original, whenever that was there; of
            an orientation, the greatest angle from all that the original has; of a value, how far it left
            the original's range; None for angles that are values.
        tolerance: difference up to which it counts as the same.
        spread: how far apart it ends in runs of the original with different seeds.
        aside_spread: how far these runs leave the paths or ranges of each other.
        is_value: whether it is a value, and no place.
    """

    name: str
    unit: str
    first: float
    largest: float
    at: float
    final: float
    aside: float | None = None
    tolerance: float = 0.0
    spread: float = 0.0
    aside_spread: float = 0.0
    is_value: bool = False

    @property
    def deviation(self) -> float:
        """The deviation that delay alone cannot explain, in units of the original's spread.

        A turn on the way counts ``TURN_ON_THE_WAY`` of it.
        """
        is_turn = self.unit == "deg" and not self.is_value
        return max(self.of_end, self.of_way * TURN_ON_THE_WAY if is_turn else self.of_way)

    @property
    def of_end(self) -> float:
        """The difference at the end in units of the original's spread."""
        return deviation_of(self.final, self.spread, self.tolerance)

    @property
    def of_way(self) -> float:
        """The distance from the original's path, orientations or range in units of its spread."""
        return deviation_of(self.aside or 0.0, self.aside_spread, self.tolerance)

    @property
    def is_delay(self) -> bool:
        """Whether it may have taken the same path at other times."""
        return max(self.final, self.aside or 0.0) <= self.tolerance


@frozen
class Measurement:
    """A measurement of one motion or contact, as the mutant and as the original.

    Attributes:
        name: what was measured, such as ``release height``.
        thing: of what, such as ``box``.
        unit: of the numbers: m, m/s or s.
        value: as the mutant; None if it did not happen.
        original: as the original; None if it does not happen there.
        at: when, s; None if it did not happen.
        tolerance: difference up to which it counts as the same.
        spread: by how much it differs in runs of the original with different seeds.
    """

    name: str
    thing: str
    unit: str
    value: float | None
    original: float | None
    at: float | None = None
    tolerance: float = 0.0
    spread: float = 0.0

    @property
    def deviation(self) -> float:
        """The difference in units of the original's spread; zero for times, which may be mere delay."""
        difference = abs((self.value or 0.0) - (self.original or 0.0))
        return 0.0 if self.unit == "s" else deviation_of(difference, self.spread, self.tolerance)


@frozen
class Diverged:
    """How a test of a mutant differs from the same test of the original.

    Attributes:
        test: node id.
        at: the first moment at which the world, or what the program commands or reads, differs, s; None
            without a clock.
        what: what differed then.
        story: what happened, in a sentence.
        apart: what was apart by more than its tolerance, largest deviation first.
        measurements: what was measured of motions and contacts, where it differs.
        fault: when the mutant changed something for the first time, s; None if that is not known.
        example: value before and after when it did so; None if that is not known.
        is_simulated: whether times are simulated; else they are of the wall clock.
        scatters: what ends far apart in runs of the original with different seeds, such as ``box by 0.52 m``;
            empty if the end of the test is stable.
    """

    test: str
    at: float | None
    what: str
    story: str
    apart: tuple[Apart, ...] = ()
    measurements: tuple[Measurement, ...] = ()
    fault: float | None = None
    example: tuple[Any, ...] | None = None
    is_simulated: bool = True
    scatters: str = ""

    @property
    def deviation(self) -> float:
        """The greatest distance of the world from the original's, in units of the original's spread."""
        found = [deviation.deviation for deviation in self.apart] + [
            measurement.deviation for measurement in self.measurements
        ]
        return max(found, default=0.0)

    @property
    def rank(self) -> tuple[bool, bool, bool, float]:
        """The sort key of a difference; the highest is that of a stable test whose world differs most."""
        is_stable = not self.scatters
        return bool(self.story) and is_stable, bool(self.story), is_stable, self.deviation
