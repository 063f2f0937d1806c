"""Recordings made by hand: a tool that carries a box from a shelf to a table."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from mutabot.evidence import recorder as recorders
from mutabot.evidence.feed import Feed
from mutabot.evidence.paths import RecordedPaths
from mutabot.evidence.recording import RecordedCall, Recording
from mutabot.evidence.story import diverged
from mutabot.model.world_difference import Diverged

Place = tuple[float, float, float]
SHELF: Place = (0.0, 0.0, 0.525)
TABLE: Place = (1.0, 0.0, 0.025)
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def line(start: Place, end: Place, seconds: float) -> Iterable[Place]:
    """Places on the way, ten a second, without the first."""
    count = round(seconds * 10)
    for number in range(1, count + 1):
        share = number / count
        yield tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))  # type: ignore[misc]


def recorded(
    tool: Sequence[Place],
    box: Sequence[Place] | None = None,
    touching: Callable[[int], set[tuple[str, str]]] = lambda number: set(),
    calls: Sequence[RecordedCall] = (),
) -> Recording:
    """What a simulator tells whose tool and box are at these places, ten a second."""
    recorder = recorders.begin()
    now = [0]
    feed = Feed(lambda: now[0] / 10)
    feed.pose("tool", lambda: (*tool[now[0]], *UPRIGHT))
    if box is not None:
        feed.pose("box", lambda: (*box[now[0]], *UPRIGHT), size=(0.05, 0.05, 0.05))
    feed.block("shelf", (0.0, 0.0, 0.25), (0.4, 0.4, 0.5))
    feed.block("table", (1.0, 0.0, -0.05), (0.4, 0.4, 0.1))
    feed.contacts(lambda: touching(now[0]))
    for number in range(len(tool)):
        now[0] = number
        feed.tick()
    recorders.stop()
    recorder.recording.calls = list(calls)
    recorder.recording.is_simulated = True
    return recorder.recording


def apart(original: Recording, mutant: Recording, *, is_cut: bool = False) -> Diverged | None:
    """How the second differs from the first."""
    return diverged("test_it", RecordedPaths(original), RecordedPaths(mutant), is_cut=is_cut)


def story(original: Recording, mutant: Recording, *, is_cut: bool = False) -> str:
    """The sentence of a mutant that differs."""
    found = apart(original, mutant, is_cut=is_cut)
    assert found is not None
    return found.story
