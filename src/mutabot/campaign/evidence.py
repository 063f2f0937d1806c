"""Keep what is recorded of mutants where it differs from the original."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import lru_cache
from hashlib import blake2b
from typing import TYPE_CHECKING

from mutabot.errors import JournalError
from mutabot.evidence.differences import noise_between
from mutabot.evidence.paths import RecordedPaths
from mutabot.evidence.recording import TrackKind, bytes_of, from_bytes
from mutabot.evidence.spread import spread_between
from mutabot.evidence.story import diverged
from mutabot.journal.recordings import ORIGINAL, Rank, Recordings
from mutabot.journal.row_checks import UNFIT

if TYPE_CHECKING:
    from mutabot.campaign.request import Progress, Request
    from mutabot.evidence.differences import Spread
    from mutabot.evidence.recording import Recording
    from mutabot.model import Diverged, Mutant
    from mutabot.model.events import TestEnd

#: recordings of the original that are held to compare with
_HELD = 64
#: problems that are reported
_SHOWN = 3


@dataclass
class CampaignEvidence:
    """The recordings of a campaign.

    Args:
        recordings: where they are kept.

    Attributes:
        problems: what could not be recorded, one line each.
        is_lost: whether the recordings cannot be used any more.
        has_tracks: whether anything is known of where things are.
    """

    recordings: Recordings
    problems: dict[str, None] = field(default_factory=dict)
    is_lost: bool = False
    has_tracks: bool = False
    _noise: dict[tuple[int, str], Mapping[str, float]] = field(default_factory=dict)
    _passed: dict[str, list[int]] = field(default_factory=dict)
    _digests: dict[tuple[int, str], bytes] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._original = lru_cache(_HELD)(self._read_original)
        self._spread = lru_cache(None)(self._spread_of)

    def begin(self, runs: Iterable[tuple[int, int, Iterable[TestEnd]]], mutants: Iterable[Mutant]) -> None:
        """Begin to keep recordings, once the baseline is taken.

        Args:
            runs: round, repetition, and the ends of the tests.
            mutants: all that the program has; what was recorded of others makes way.
        """
        self.recordings.keep_only({mutant.id for mutant in mutants})
        for round, repetition, ends in sorted(runs, key=lambda run: run[:2]):
            if repetition == 0:
                self.recordings.forget(ORIGINAL, round)  # what an earlier campaign recorded makes way
            for end in ends:
                if repetition:
                    self.add_rerun(round, end)
                elif end.recording is not None:
                    found = self._add_original(round, end, end.recording)
                    self.problems.update(dict.fromkeys(found.problems))

    def add_seed(self, round: int, ends: Iterable[TestEnd]) -> None:
        """Add runs of the original with the seed of a round in which no mutant runs."""
        self.recordings.forget(ORIGINAL, round)
        for end in ends:
            if end.recording is not None:
                self._add_original(round, end, end.recording)

    def _add_original(self, round: int, end: TestEnd, recording: str) -> Recording:
        data = bytes_of(recording)
        self._digests[round, end.test] = _digest(recording)
        self.recordings.add(ORIGINAL, round, end.test, Rank.ORIGINAL, data)
        found = from_bytes(data)
        self.has_tracks |= any(track.kind is not TrackKind.LINE for track in found.tracks.values())
        if end.outcome == "passed":
            self._passed.setdefault(end.test, []).append(round)
        return found

    def add_rerun(self, round: int, end: TestEnd) -> None:
        """Add a further run of the original, which shows how far things are apart without any fault."""
        changed = self._changed(round, end)
        found = noise_between(*changed[:2]) if changed is not None else {}
        if any(found.values()):
            self._noise[round, end.test] = found

    def take(
        self, mutant: str, round: int, ends: Iterable[TestEnd], *, survived: bool
    ) -> tuple[Diverged, ...]:
        """Keep what differs of a mutant's tests. Return the differences, the most telling first.

        Recordings that can no longer be read or written cost no outcome, whatever the cause.
        """
        try:
            return () if self.is_lost else self._take(mutant, round, ends, survived=survived)
        except (JournalError, *UNFIT) as error:
            self.is_lost = True
            self.problems[f"nothing is recorded any more from mutant {mutant} on: {error}"] = None
            return ()

    def _take(
        self, mutant: str, round: int, ends: Iterable[TestEnd], *, survived: bool
    ) -> tuple[Diverged, ...]:
        found = []
        self.recordings.forget(mutant, round)
        for end in ends:
            changed = self._changed(round, end)
            if changed is None:
                continue
            original, seen, data = changed
            noise, spread = self._noise.get((round, end.test)), self._spread(end.test)
            divergence = diverged(end.test, original, seen, noise, spread, is_cut=end.outcome == "failed")
            if divergence is not None:
                divergence = replace(divergence, example=end.example)
                rank = Rank.SURVIVOR if survived else Rank.OTHER
                self.recordings.add(mutant, round, end.test, rank, data)
                found.append(divergence)
        return tuple(sorted(found, key=lambda divergence: divergence.rank, reverse=True))

    def _changed(self, round: int, end: TestEnd) -> tuple[RecordedPaths, RecordedPaths, bytes] | None:
        """Return the original's recording of a test, this one, and its data; None if they are the same."""
        if end.recording is None or _digest(end.recording) == self._digests.get((round, end.test)):
            return None
        original, data = self._original(round, end.test), bytes_of(end.recording)
        return None if original is None else (original, RecordedPaths(from_bytes(data)), data)

    def scattering(self, tests: Iterable[str]) -> set[str]:
        """Return the tests without a stable end: with other seeds the original ends far from it."""
        try:
            return set() if self.is_lost else {test for test in tests if self._spread(test).scatters}
        except (JournalError, *UNFIT):  # the recordings were spoiled: the next one that is taken says so
            return set()

    def _spread_of(self, test: str) -> Spread:
        """Return how far the original's runs of a test with different seeds are apart."""
        runs = (self._original(round, test) for round in self._passed.get(test, ()))
        return spread_between([run for run in runs if run is not None])

    def _read_original(self, round: int, test: str) -> RecordedPaths | None:
        data = self.recordings.data(ORIGINAL, round, test)
        return RecordedPaths(from_bytes(data)) if data is not None else None


@contextmanager
def recorded(request: Request, progress: Progress) -> Iterator[CampaignEvidence | None]:
    """Yield the recordings of a campaign, None if none are asked for; report at the end what is missing."""
    if not request.evidence:
        yield None
        return
    limit = request.configuration.evidence
    with Recordings.to_write(request.journal_path, limit) as recordings:
        evidence = CampaignEvidence(recordings)
        if recordings.removed:
            progress.note(
                f"{recordings.path} was {recordings.removed}; it is made again, without earlier recordings"
            )
        try:
            yield evidence
        finally:
            for problem in list(evidence.problems)[:_SHOWN]:
                progress.note(problem)
            if recordings.dropped:
                progress.note(
                    f"{recordings.dropped} recordings found no room in {limit / 1e6:.0f} MB and were left "
                    "out: set `evidence` to more"
                )


def _digest(recording: str) -> bytes:
    return blake2b(recording.encode(), digest_size=16).digest()
