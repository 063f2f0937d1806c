"""The interface by which a simulator, or a node connected to it, reports the positions of things."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import floor, inf, isfinite
from typing import TYPE_CHECKING, Any

from . import tape as tapes
from .recording import Block, TrackKind

if TYPE_CHECKING:
    from .tape import Tape

Triple = tuple[float, float, float]
#: seconds that a new simulation in the same test comes after the one before
_GAP = 1e-3
#: by so much may sums of time steps be off
_HAIR = 1e-6


@dataclass(slots=True)
class _Source:
    name: str
    kind: TrackKind
    read: Callable[[], Any]
    unit: str = ""
    size: Triple | None = None
    radii: tuple[float, ...] = ()


class Feed:
    """Records tool and objects at a fixed rate of simulated time while a test is recorded.

    Outside a campaign ``tick`` does nothing, and costs next to nothing. What is told is only read: it must
    change nothing in the simulation and draw no random number.

    Args:
        time: gives the simulated time, s. If it goes back (an episode begins anew), it is counted on.
        rate: moments per simulated second.
    """

    def __init__(self, time: Callable[[], float], *, rate: float = 10.0) -> None:
        if not rate > 0:
            raise ValueError(f"a rate of {rate!r} per second; it must be above 0, such as 10")
        self._time, self._interval = time, 1.0 / rate
        self._sources: list[_Source] = []
        self._blocks: list[Block] = []
        self._touching: Callable[[], Iterable[tuple[str, str]]] | None = None
        self._robots: tuple[str, ...] = ()
        self._camera: Callable[[], Any] | None = None
        self._shutter = self._next_picture = 0.0
        self._tape: Tape | None = None
        self._before: frozenset[tuple[str, str]] = frozenset()
        self._offset = self._last = self._due = 0.0

    def pose(self, name: str, read: Callable[[], Sequence[float]], *, size: Triple | None = None) -> None:
        """Record a thing with a position and an orientation.

        Args:
            read: gives x, y, z in m and the quaternion w, x, y, z: seven numbers, world frame.
            size: edge lengths in m, if it is about a box.
        """
        self._sources.append(_Source(name, TrackKind.POSE, read, "", size))

    def point(self, name: str, read: Callable[[], Sequence[float]], *, size: Triple | None = None) -> None:
        """Record a thing with a position; ``read`` returns x, y, z in m, world frame."""
        self._sources.append(_Source(name, TrackKind.POINT, read, "", size))

    def value(self, name: str, read: Callable[[], float], *, unit: str = "") -> None:
        """Record a number, such as the opening of a gripper or the margin of a monitor."""
        self._sources.append(_Source(name, TrackKind.VALUE, read, unit))

    def line(self, name: str, read: Callable[[], Sequence[float]], *, radii: Sequence[float]) -> None:
        """Record a line that is drawn and never compared, such as an arm from its base through its joints.

        Args:
            read: gives x, y, z of one point after the other in m, world frame: three numbers per radius. They
                are kept to a millimetre.
            radii: how thick it is at each of its points, m.
        """
        self._sources.append(_Source(name, TrackKind.LINE, read, radii=tuple(map(float, radii))))

    def contacts(self, read: Callable[[], Iterable[tuple[str, str]]], *, robots: Iterable[str] = ()) -> None:
        """Record which bodies touch.

        Args:
            read: gives the pairs of names that touch each other now.
            robots: which names are parts of robots, such as ``gripper``; if none are given, all that are
                neither tracked nor blocks.
        """
        self._touching, self._robots = read, tuple(robots)

    def block(self, name: str, centre: Triple, size: Triple, colour: Sequence[float] | None = None) -> None:
        """Record a box that never moves, such as a table: centre and edge lengths in m, world frame."""
        self._blocks.append(
            Block(name, _triple(centre), _triple(size), None if colour is None else tuple(colour))
        )

    def camera(self, read: Callable[[], Any], *, rate: float = 25.0) -> None:
        """Take pictures of the world, for ``mutabot motion MUTANT --video``; campaigns take none.

        Args:
            read: gives a picture of the world as it is now: an array of bytes (uint8) of the shape (height,
                width, 3), or with a fourth number per pixel that is left out; None as long as there is none.
                What it needs for that, such as a renderer, it should make when it is first called.
            rate: pictures per simulated second.
        """
        if not rate > 0:
            raise ValueError(f"a rate of {rate!r} pictures per second; it must be above 0, such as 25")
        self._camera, self._shutter = read, 1.0 / rate

    def note(self, text: str) -> None:
        """Record an event that happens now."""
        tape = tapes.running()
        now = self._now(tape) if tape is not None else None
        if tape is not None and now is not None:
            if tape is not self._tape:
                self._begin(tape, now)
            tape.note(self._offset + now, "note", text)

    @property
    def due(self) -> float:
        """The simulated time (s) before which ``tick`` records nothing; inf while no test is recorded.

        For a simulator that takes many steps at once: calls of ``tick`` before it may be left out.
        """
        tape = tapes.running()
        if tape is None:
            return inf
        if tape is not self._tape:
            return -inf
        return self._due if tape.film is None else min(self._due, self._next_picture)

    def tick(self) -> None:
        """Record the current moment, if one is due. Call it after each step, or for each message."""
        tape = tapes.running()
        if tape is not None:
            with tape.aside():
                self._tick(tape)

    def _now(self, tape: Tape) -> float | None:
        """Return the simulator's own time (s); None if it has none, which is noted."""
        with tape.reading("the simulated time cannot be read"):
            now = float(self._time())
            if isfinite(now):
                return now
            tape.problem(f"the simulated time cannot be read: {now} is not a time")
        return None

    def _tick(self, tape: Tape) -> None:
        now = self._now(tape)
        if now is None:
            return
        if tape is not self._tape:
            self._begin(tape, now)
        elif now < self._last:
            self._go_on(tape, now)
        self._last = now
        tape.end = self._offset + now
        if now >= self._due - _HAIR:
            step = self._interval * tape.coarseness
            self._due = (floor(now / step + _HAIR) + 1) * step
            self._sample(tape, self._offset + now)
        if tape.film is not None and self._camera is not None and now >= self._next_picture - _HAIR:
            self._take_picture(tape, now, self._camera)

    def _take_picture(self, tape: Tape, now: float, read: Callable[[], Any]) -> None:
        self._next_picture = (floor(now / self._shutter + _HAIR) + 1) * self._shutter
        if tape.filmed_by is self:
            tape.picture(self._offset + now, read)

    def _begin(self, tape: Tape, now: float) -> None:
        """Begin to record a test, at time 0 even if the simulation already ran."""
        self._tape = tape
        is_first = not tape.recording.times
        self._offset = -now if is_first else tape.end + _GAP - now
        self._last = self._due = self._next_picture = now
        if self._camera is not None:
            tape.filmed_by = self
        self._before = frozenset()
        for block in self._blocks:
            tape.block(block)
        tape.recording.robots = tuple(dict.fromkeys((*tape.recording.robots, *self._robots)))
        tape.use_clock(lambda: self._offset + self._time())
        tape.at_end.append(lambda: self._finish(tape))

    def _finish(self, tape: Tape) -> None:
        """Record the last moment of a test."""
        with tape.aside():
            now, times = self._offset + self._time(), tape.recording.times
            if tape is self._tape and times and now > times[-1] + _HAIR:
                self._sample(tape, now)

    def _go_on(self, tape: Tape, now: float) -> None:
        """Continue after simulated time was reset: later moments follow all earlier ones."""
        self._offset = tape.end + _GAP - now
        self._due = self._next_picture = now
        self._before = frozenset()

    def _sample(self, tape: Tape, now: float) -> None:
        for source in self._sources:
            track = tape.track(source.name, source.kind, source.unit, source.size, source.radii)
            length = len(track.values)
            with tape.reading(f"{source.name} cannot be recorded"):
                found = [source.read()] if source.kind is TrackKind.VALUE else list(source.read())
                if len(found) == track.width:
                    track.values.extend(map(_coarse, found) if track.radii else found)
                    continue
                why = f"{len(found)} numbers instead of {track.width}"
                tape.problem(f"{source.name} cannot be recorded: {why}")
            del track.values[length:]
        tape.close_moment(now)
        if self._touching is not None:
            self._note_contacts(tape, now, self._touching)

    def _note_contacts(self, tape: Tape, now: float, read: Callable[[], Iterable[tuple[str, str]]]) -> None:
        touching = self._before
        with tape.reading("contacts cannot be recorded"):
            touching = frozenset((min(pair), max(pair)) for pair in ((str(a), str(b)) for a, b in read()))
        for what, changed in (("part", self._before - touching), ("touch", touching - self._before)):
            for pair in sorted(changed):
                tape.note(now, what, ", ".join(pair))
        self._before = touching


def _coarse(number: float) -> float:
    """Round a coordinate to a millimetre, which is enough to be drawn and saves space."""
    return round(number * 1024) / 1024 if isfinite(number) else number


def _triple(numbers: Sequence[float]) -> Triple:
    x, y, z = numbers
    return float(x), float(y), float(z)
