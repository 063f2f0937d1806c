"""The recording of the running test: what feeds tell of the world."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace

from mutabot.border.job import Pictures
from mutabot.evidence import tape as tapes
from mutabot.evidence.recording import Told, to_text
from mutabot.evidence.tape import FilmWriter, Tape


class TestRecording:
    """The recording of the running test; nothing is recorded where it is not asked for."""

    __test__ = False

    def __init__(self) -> None:
        self._tape: Tape | None = None
        self._film: FilmWriter | None = None
        self._filmed: str | None = None

    def film(self, pictures: Pictures) -> None:
        """Film a test that is still to come."""
        self._film, self._filmed = FilmWriter(pictures.file), pictures.test

    def start(
        self,
        is_wanted: bool,
        test: str,
        clock: Callable[[], float | None],
        aside: Callable[[], AbstractContextManager[object]],
        *,
        is_simulated: bool,
    ) -> None:
        """A test begins.

        Args:
            test: its node id.
            clock: tells its simulated time, s, as long as no feed does.
            aside: what feeds read in this context is none of the program's calls.
            is_simulated: whether it is known that there is such a time.
        """
        tapes.stop()
        film = self._film if test == self._filmed else None
        self._tape = tapes.begin(film) if is_wanted else None
        if self._tape is not None:
            self._tape.aside = aside
            self._tape.clock, self._tape.is_simulated = clock, is_simulated

    def stop(self) -> None:
        """The test is over; its world may be taken down."""
        tape = tapes.running()
        if tape is not None:
            tape.finish()
        tapes.stop()

    def clock(self) -> float | None:
        """The time, as the tape has it; None where nothing is recorded."""
        tape = tapes.running()
        return tape.now if tape is not None else None

    def since(self, moment: float) -> float | None:
        """A moment of the clock of ``time.monotonic`` as a time of the tape; None without one."""
        return self._tape.at_wall(moment) if self._tape is not None else None

    def note_fault(self, calls: int, time: float | None) -> None:
        """The mutant has changed something, for the first time or once more, after so many calls."""
        if self._tape is not None and self._tape.recording.faulty_call is None:
            self._tape.recording.faulty_call = calls
            self._tape.recording.fault = time

    def text(self, calls: Sequence[Told]) -> str | None:
        """All of it and the calls, as ``TestEnd.recording``; None where nothing is recorded."""
        if self._tape is None:
            return None
        tape, recording = self._tape, self._tape.recording
        recording.is_simulated = tape.is_simulated
        recording.fault = tape.seconds(recording.fault)
        timed = (replace(one, began=tape.seconds(one.began), ended=tape.seconds(one.ended)) for one in calls)
        recording.calls = sorted(timed, key=lambda one: one.began or 0.0)
        try:
            return to_text(recording)
        except (TypeError, ValueError, RecursionError) as error:  # values of the user's may be anything
            tape.problem(f"the calls of a test cannot be recorded: {type(error).__name__}: {error}")
            recording.calls = []
            return to_text(recording)
