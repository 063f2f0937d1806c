"""What a process below the tests runs of a job without operations: the program text alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.border.events import Acted, SiteSeen
from mutabot.border.job import Budget, Job
from mutabot.inside.evidence import Evidence, together
from mutabot.inside.limits import Meter
from mutabot.inside.text.session_text import SessionText

if TYPE_CHECKING:
    from mutabot.inside.event_file import Sink


def is_of_text_alone(job: Job) -> bool:
    """Whether a job has nothing to do with calls, so that what sees them need not be loaded."""
    return not (job.vocabulary.operations or job.vocabulary.clock or job.faults)


class TextOnly:
    """What ``inside.session.Session`` is of a job that has nothing to do with calls.

    Args:
        job: what to do.
        pipe: where reports go.

    Attributes:
        text: the program text, if it is instrumented.
        test: node id of the running test.
        meter: what the running test has used.
        commands, sites, branch: of calls there are none.
    """

    commands = 0
    sites: tuple[SiteSeen, ...] = ()
    branch: str | None = None

    def __init__(self, job: Job, pipe: Sink) -> None:
        self.job, self.pipe = job, pipe
        self.text: SessionText | None = None
        self.test = ""
        self.meter = Meter(Budget())

    def install(self) -> None:
        """Instrument the program from now on, and the mutant with it."""
        self.text = SessionText.of(self.job, self.pipe, self._acted)

    def start_test(self, test: str) -> None:
        """A test begins."""
        self.test = test
        self.meter = Meter(self.job.budgets.get(test, Budget()))
        if self.text is not None:
            self.text.start_test(test, None, {})

    def look_back(self, *, at_all: bool = False) -> None:
        """No mutant has handed out anything."""

    @property
    def evidence(self) -> Evidence:
        """What the mutant did in the running test."""
        return together([self.text.evidence] if self.text is not None and self.text.is_mutant else [])

    def _acted(self) -> None:
        self.pipe.send(Acted(self.test))
