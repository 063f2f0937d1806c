"""The recorder of the running test, which feeds write to and the session reads, and its film.

There is one recorder per process. Outside a campaign, and between tests, there is none and feeds do nothing.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from typing import Any, Protocol

from mutabot.model.clocks import monotonic

from .recording import Block, RecordedMoment, Recording, Track, TrackKind

#: pictures from which on no more are taken: four minutes at 25 per second
MOST_PICTURES = 6000


class PictureWriter(Protocol):
    """The interface of a writer of pictures.

    Attributes:
        count: how many there are.
    """

    count: int

    def add(self, time: float, picture: Any) -> None:
        """Add a picture. Raises ValueError if it is no picture, TypeError if it holds no numbers.

        Args:
            time: s.
            picture: shape (height, width, 3) or (height, width, 4), of bytes.
        """


#: moments from which on only every second one is kept, and half as many are taken from then on
_MOST_MOMENTS = 4000
_MOST_EVENTS = 2000
_NAN = float("nan")
#: s: distinguishes times of the wall clock from simulated ones
_WALL = 1.0


class WorldRecorder:
    """The recorder of one test.

    Attributes:
        recording: it, so far.
        end: the last moment that a feed reported, s.
        coarseness: how many times its interval a feed is to wait between two moments.
        clock: returns the simulated time, s; None as long as no feed or simulator has reported any.
        is_simulated: whether its times are simulated.
        at_end: what is to be done once more when the test is over, while its world is still there.
        film: takes pictures down; None if the test is not filmed.
        aside: what is read in this context is no call of the program's, whichever function reads it.
        filmed_by: whose pictures it takes: of several simulations those of the last that began.
    """

    def __init__(self, film: PictureWriter | None = None) -> None:
        self.recording = Recording()
        self.film = film
        self.filmed_by: object = None
        self.aside: Callable[[], AbstractContextManager[object]] = nullcontext
        self.end = 0.0
        self.coarseness = 1
        self.clock: Callable[[], float | None] | None = None
        self.is_simulated = False
        self.at_end: list[Callable[[], None]] = []
        self._began = monotonic()

    @property
    def now(self) -> float:
        """The current time, to be converted by ``seconds`` when the test is over.

        It is unknown before whether anything will report the simulated time. Until something does, it is that
        of the wall clock, below zero so that it is known for what it is.
        """
        time = self._clock_time()
        return self.at_wall(monotonic()) if time is None else time

    def at_wall(self, moment: float) -> float:
        """Return a moment of ``time.monotonic`` as a time of the recorder."""
        return self._began - moment - _WALL

    def seconds(self, time: float | None) -> float | None:
        """Return the seconds since the test began at this time, simulated if there is a simulated clock."""
        if time is None or time >= 0.0:
            return time
        return 0.0 if self.is_simulated else -time - _WALL

    def finish(self) -> None:
        """End the recording of a test."""
        for last in self.at_end:
            with suppress(Exception):  # a simulator that the test has closed already
                last()
        self.at_end.clear()

    def use_clock(self, clock: Callable[[], float]) -> None:
        """Use this function for the simulated time, s."""
        self.clock, self.is_simulated = clock, True

    def _clock_time(self) -> float | None:
        try:
            return self.clock() if self.clock is not None else None
        except Exception as error:  # a simulator that was closed: the program's calls must go on
            self.problem(f"the simulated time cannot be read: {type(error).__name__}: {error}")
            self.clock = lambda: self.end
            return self.end

    def track(
        self,
        name: str,
        kind: TrackKind,
        unit: str,
        size: tuple[float, float, float] | None,
        radii: tuple[float, ...] = (),
    ) -> Track:
        """Return the track of this name; a new one begins at the current moment."""
        found = self.recording.tracks.get(name)
        if found is None:
            found = self.recording.tracks[name] = Track(name, kind, array("f"), unit, size, radii)
            found.values = array("f", [_NAN]) * (found.width * len(self.recording.times))
        return found

    def close_moment(self, now: float) -> None:
        """Add a moment; tracks that were not read at it get no value."""
        times = self.recording.times
        times.append(now)
        for track in self.recording.tracks.values():
            missing = track.width * len(times) - len(track.values)
            if missing:
                track.values.extend([_NAN] * missing)
        if len(times) >= _MOST_MOMENTS:
            self._thin()

    def note(self, now: float, what: str, text: str) -> None:
        """Record an event."""
        if len(self.recording.moments) < _MOST_EVENTS:
            self.recording.moments.append(RecordedMoment(now, what, text))
        else:
            last = self.recording.moments[-1].time
            self.problem(f"more than {_MOST_EVENTS} events in a test: those after {last:.4g} s are left out")

    def picture(self, now: float, read: Callable[[], Any]) -> None:
        """Take a picture, if the test is filmed. A camera that fails is not asked again."""
        film, self.film = self.film, None
        if film is None:
            return
        with self.reading("pictures cannot be taken"):
            found = read()
            if found is not None:
                film.add(now, found)
            if film.count < MOST_PICTURES:
                self.film = film
                return
            text = f"more than {MOST_PICTURES} pictures in a test: those after {now:.4g} s are left out"
            self.problem(text)

    def block(self, block: Block) -> None:
        """Record a box that never moves."""
        if block not in self.recording.blocks:
            self.recording.blocks = (*self.recording.blocks, block)

    @contextmanager
    def reading(self, what: str) -> Iterator[None]:
        """Turn errors of the user's code into a problem with ``what``, so that the test continues."""
        try:
            yield
        except Exception as error:
            self.problem(f"{what}: {type(error).__name__}: {error}")

    def problem(self, text: str) -> None:
        """Note why something cannot be recorded."""
        if text not in self.recording.problems:
            self.recording.problems.append(text)

    def _thin(self) -> None:
        """Drop every second moment."""
        self.coarseness *= 2
        recording = self.recording
        recording.times = recording.times[::2]
        for track in recording.tracks.values():
            width, values = track.width, track.values
            track.values = array(
                "f",
                (
                    value
                    for number in range(0, len(values), 2 * width)
                    for value in values[number : number + width]
                ),
            )


_recorder: WorldRecorder | None = None


def running() -> WorldRecorder | None:
    """Return the recorder of the running test; None if nothing is recorded."""
    return _recorder


def now() -> float | None:
    """Return the time of the running test's recorder; None if nothing is recorded."""
    return _recorder.now if _recorder is not None else None


def begin(film: PictureWriter | None = None) -> WorldRecorder:
    """Begin to record a test, and to film it if asked."""
    global _recorder  # noqa: PLW0603  # simulators know this module, not an object of ours
    _recorder = WorldRecorder(film)
    return _recorder


def stop() -> WorldRecorder | None:
    """Stop recording, and return the recording."""
    global _recorder  # see above
    found, _recorder = _recorder, None
    return found
