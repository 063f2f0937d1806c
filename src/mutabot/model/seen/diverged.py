"""How a mutant's world went another way than the original's: when, how far, and what happened."""

from __future__ import annotations

from mutabot.frozen import frozen


@frozen
class Apart:
    """How far one thing was from where it is in the original at the same time.

    Attributes:
        name: which thing, such as ``box``; ``box turned`` for its orientation.
        unit: of the numbers: m, deg, or that of a value.
        first: when it was apart first by more than the tolerance, s.
        largest: greatest difference, and ``at`` when, s.
        final: difference at the end.
        aside: of a position, the greatest distance from the path of the original, whenever that was there; of
            a value, how far it left the original's range; None for orientations.
        tolerance: difference up to which it counts as the same.
    """

    name: str
    unit: str
    first: float
    largest: float
    at: float
    final: float
    aside: float | None = None
    tolerance: float = 0.0

    @property
    def worst(self) -> float:
        """What cannot be mere delay, in multiples of the tolerance."""
        return max(self.final, self.aside or 0.0) / self.tolerance

    @property
    def is_delay(self) -> bool:
        """Whether it may have gone the same way at other times."""
        return self.worst <= 1.0


@frozen
class Near:
    """How near something came to something that never moves.

    Attributes:
        body, obstacle: which.
        distance: m; 0 if they overlapped. Boxes are taken as they stand, whichever way they are turned.
        at: when, s.
        original: the least distance in the original, m.
    """

    body: str
    obstacle: str
    distance: float
    at: float
    original: float


@frozen
class Diverged:
    """How the world of one test differs from the original's.

    Attributes:
        test: node id.
        at: the first moment at which the world, or what the program commands or reads, differs, s; None
            without a clock.
        what: what differed then.
        story: what happened, in a sentence.
        apart: what was apart by more than its tolerance, worst first.
        near: closest approaches that are closer than in the original, closest first.
        fault: when the mutant changed something for the first time, s; None if that is not known.
        is_simulated: whether times are simulated; else they are of the wall clock.
    """

    test: str
    at: float | None
    what: str
    story: str
    apart: tuple[Apart, ...] = ()
    near: tuple[Near, ...] = ()
    fault: float | None = None
    is_simulated: bool = True

    @property
    def worst(self) -> float:
        """How far the world was from the original's at the worst moment, in multiples of the tolerance."""
        return max((one.worst for one in self.apart), default=0.0)
