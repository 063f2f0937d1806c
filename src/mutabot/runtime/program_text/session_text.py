"""The program text of a session: which alternatives stand in it, what they did, and what was seen of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from mutabot.model.events import NotInstrumented, PlacesReached, TextsSeen
from mutabot.model.job import Job
from mutabot.runtime.event_file import Sink
from mutabot.runtime.evidence import Evidence
from mutabot.runtime.program_text.import_hook import ImportHook

if TYPE_CHECKING:  # not every process makes calls, or forks
    from mutabot.model import Call, Choice

#: hits, and hits at which something changed, by place
_Counts = dict[int, tuple[int, int]]


class SessionText:
    """The program text of the job at hand.

    What happens while the program is imported, before any test, holds for every test after it: each test
    counts it as its own.

    Args:
        hook: what instruments the program's files.
        pipe: where reports go; a copy of a fork server gets its own.
        on_act: told when all active alternatives have changed something in a test.
    """

    def __init__(self, hook: ImportHook, pipe: Sink, on_act: Callable[[], None]) -> None:
        self.hook = hook
        self.pipe = pipe
        self._on_act = on_act
        self._test = ""
        self._begun = False
        self._early: _Counts = {}
        self._early_example: tuple[Any, ...] | None = None
        self._refusals: tuple[BaseException, ...] = ()
        self._unknown = False
        hook.alternatives.on_act = self._acted

    @classmethod
    def of(cls, job: Job, pipe: Sink, on_act: Callable[[], None]) -> SessionText | None:
        """Instrument the program from now on; None if the job leaves its text alone."""
        if job.instrumentation is None:
            return None

        def tell(file: str, why: str) -> None:
            text.pipe.send(NotInstrumented(file, why))

        text = cls(ImportHook(job.root, job.instrumentation, tell), pipe, on_act)
        text.hook.install()
        return text

    @property
    def is_mutant(self) -> bool:
        """Whether an alternative is active."""
        return bool(self.hook.alternatives.active)

    def start_test(self, test: str) -> None:
        """A test begins."""
        if not self._begun:
            self._note_early()
        self._test, self._refusals, self._unknown = test, (), False
        if self.hook.sightings is not None:
            self.hook.sightings.start()
        else:
            self.hook.alternatives.start()

    def watch(
        self, on_place: Callable[[int, frozenset[int]], None], live: Mapping[int, frozenset[int]]
    ) -> None:
        """In a fork parent: tell ``on_place`` which of the ``live`` alternatives of a place are to differ."""
        self.hook.alternatives.on_place = on_place
        self.hook.alternatives.watch(live)

    def end_test(self) -> None:
        """The test is over."""
        if self.hook.sightings is not None:
            self._tell_reached()
        elif self.hook.alternatives.on_place is not None and not self.is_mutant:
            self.hook.alternatives.watch({})  # what is reached between tests belongs to none

    def finish(self, others: Iterable[TextsSeen] = ()) -> None:
        """All tests are over; ``others`` is what was seen in processes below them."""
        if self.hook.sightings is not None:
            others = list(others)
            imported = dict.fromkeys(
                [*self.hook.imported, *(file for one in others for file in one.imported)]
            )
            seen = [*self.hook.sightings.seen(), *(seen for one in others for seen in one.sightings)]
            self.pipe.send(TextsSeen(tuple(imported), tuple(seen)))

    def become(self, choices: Iterable[Choice]) -> None:
        """In a process that was just forked: let these alternatives stand in the text, and watch none."""
        self.hook.alternatives.on_place = None
        self.hook.alternatives.activate(*choices)

    @property
    def hits(self) -> Mapping[int, int]:
        """Evaluations in the running test of each place that was on."""
        return self.hook.alternatives.hits

    @property
    def early(self) -> Mapping[int, int]:
        """The same before any test."""
        return {place: hits for place, (hits, _) in self._early.items()}

    def raised(self, error: BaseException, call: Call, refusals: Iterable[str]) -> None:
        """An operation raised: if the robot refuses what it was told, that may be the mutant's doing."""
        from mutabot.runtime.interception.active_mutant import is_refusal, with_refusal  # noqa: PLC0415

        if self.is_mutant and self.has_acted and is_refusal(error, refusals):
            self._refusals = with_refusal(self._refusals, error)
            # the vocabulary says what commands there are; this is none of them
            self._unknown = call.operation.message is not None and call.pattern is None

    @property
    def evidence(self) -> Evidence:
        """What the mutant did in the running test. One of several alternatives acts if all of them did."""
        counts = [self._count(place) for place in self.hook.alternatives.active]
        examples = self.hook.alternatives.examples
        return Evidence(
            hits=min((hits for hits, _ in counts), default=0),
            acted=min((acted for _, acted in counts), default=0),
            example=next(iter(examples.values()), self._early_example),
            refusals=self._refusals,
            is_of_text=True,
            is_unknown=self._unknown,
        )

    def _note_early(self) -> None:
        self._begun = True
        alternatives = self.hook.alternatives
        if self.hook.sightings is not None:
            self._tell_reached()
        self._early = {place: self._count(place) for place in alternatives.hits}
        self._early_example = next(iter(alternatives.examples.values()), None)

    def _tell_reached(self) -> None:
        assert self.hook.sightings is not None
        self.pipe.send(PlacesReached(self._test, tuple(sorted(self.hook.sightings.reached()))))

    def _count(self, place: int) -> tuple[int, int]:
        hits, acted = self._early.get(place, (0, 0))
        alternatives = self.hook.alternatives
        return hits + alternatives.hits.get(place, 0), acted + alternatives.acted(place)

    @property
    def has_acted(self) -> bool:
        """Whether all active alternatives have changed something in this test, or before any."""
        return all(self._count(place)[1] for place in self.hook.alternatives.active)

    def _acted(self, place: int) -> None:
        if self.has_acted:
            self._on_act()
