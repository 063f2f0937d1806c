"""The interface by which a simulator, or a node connected to it, reports the positions of things."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import floor, inf, isfinite
from typing import TYPE_CHECKING, Any

from . import recorder as recorders
from .recording import Block, TrackKind

if TYPE_CHECKING:
    from .recorder import WorldRecorder

Triple = tuple[float, float, float]
#: seconds that a new simulation in the same test comes after the one before
_GAP = 1e-3
#: largest error of sums of time steps
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

    Outside a campaign ``tick`` does nothing, and costs next to nothing. What is passed is only read: it must
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
        self._recorder: WorldRecorder | None = None
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
        recorder = recorders.running()
        now = self._now(recorder) if recorder is not None else None
        if recorder is not None and now is not None:
            if recorder is not self._recorder:
                self._begin(recorder, now)
            recorder.note(self._offset + now, "note", text)

    @property
    def due(self) -> float:
        """The simulated time (s) before which ``tick`` records nothing; inf while no test is recorded.

        For a simulator that takes many steps at once: calls of ``tick`` before it may be left out.
        """
        recorder = recorders.running()
        if recorder is None:
            return inf
        if recorder is not self._recorder:
            return -inf
        return self._due if recorder.film is None else min(self._due, self._next_picture)

    def tick(self) -> None:
        """Record the current moment, if one is due. Call it after each step, or for each message."""
        recorder = recorders.running()
        if recorder is not None:
            with recorder.aside():
                self._tick(recorder)

    def _now(self, recorder: WorldRecorder) -> float | None:
        """Return the simulator's own time (s); None if it has none, which is noted."""
        with recorder.reading("the simulated time cannot be read"):
            now = float(self._time())
            if isfinite(now):
                return now
            recorder.problem(f"the simulated time cannot be read: {now} is not a time")
        return None

    def _tick(self, recorder: WorldRecorder) -> None:
        now = self._now(recorder)
        if now is None:
            return
        if recorder is not self._recorder:
            self._begin(recorder, now)
        elif now < self._last:
            self._go_on(recorder, now)
        self._last = now
        recorder.end = self._offset + now
        if now >= self._due - _HAIR:
            step = self._interval * recorder.coarseness
            self._due = (floor(now / step + _HAIR) + 1) * step
            self._sample(recorder, self._offset + now)
        if recorder.film is not None and self._camera is not None and now >= self._next_picture - _HAIR:
            self._take_picture(recorder, now, self._camera)

    def _take_picture(self, recorder: WorldRecorder, now: float, read: Callable[[], Any]) -> None:
        self._next_picture = (floor(now / self._shutter + _HAIR) + 1) * self._shutter
        if recorder.filmed_by is self:
            recorder.picture(self._offset + now, read)

    def _begin(self, recorder: WorldRecorder, now: float) -> None:
        """Begin to record a test, at time 0 even if the simulation already ran."""
        self._recorder = recorder
        is_first = not recorder.recording.times
        self._offset = -now if is_first else recorder.end + _GAP - now
        self._last = self._due = self._next_picture = now
        if self._camera is not None:
            recorder.filmed_by = self
        self._before = frozenset()
        for block in self._blocks:
            recorder.block(block)
        recorder.recording.robots = tuple(dict.fromkeys((*recorder.recording.robots, *self._robots)))
        recorder.use_clock(lambda: self._offset + self._time())
        recorder.at_end.append(lambda: self._finish(recorder))

    def _finish(self, recorder: WorldRecorder) -> None:
        """Record the last moment of a test."""
        with recorder.aside():
            now, times = self._offset + self._time(), recorder.recording.times
            if recorder is self._recorder and times and now > times[-1] + _HAIR:
                self._sample(recorder, now)

    def _go_on(self, recorder: WorldRecorder, now: float) -> None:
        """Continue after simulated time was reset: later moments follow all earlier ones."""
        self._offset = recorder.end + _GAP - now
        self._due = self._next_picture = now
        self._before = frozenset()

    def _sample(self, recorder: WorldRecorder, now: float) -> None:
        for source in self._sources:
            track = recorder.track(source.name, source.kind, source.unit, source.size, source.radii)
            length = len(track.values)
            with recorder.reading(f"{source.name} cannot be recorded"):
                found = [source.read()] if source.kind is TrackKind.VALUE else list(source.read())
                if len(found) == track.width:
                    track.values.extend(map(_coarse, found) if track.radii else found)
                    continue
                why = f"{len(found)} numbers instead of {track.width}"
                recorder.problem(f"{source.name} cannot be recorded: {why}")
            del track.values[length:]
        recorder.close_moment(now)
        if self._touching is not None:
            self._note_contacts(recorder, now, self._touching)

    def _note_contacts(
        self, recorder: WorldRecorder, now: float, read: Callable[[], Iterable[tuple[str, str]]]
    ) -> None:
        touching = self._before
        with recorder.reading("contacts cannot be recorded"):
            touching = frozenset((min(pair), max(pair)) for pair in ((str(a), str(b)) for a, b in read()))
        for what, changed in (("part", self._before - touching), ("touch", touching - self._before)):
            for pair in sorted(changed):
                recorder.note(now, what, ", ".join(pair))
        self._before = touching


def _coarse(number: float) -> float:
    """Round a coordinate to a millimetre, which is enough to be drawn and saves space."""
    return round(number * 1024) / 1024 if isfinite(number) else number


def _triple(numbers: Sequence[float]) -> Triple:
    x, y, z = numbers
    return float(x), float(y), float(z)
