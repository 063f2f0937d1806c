"""What a process below the tests tells of calls, at once."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from mutabot.border.events import Called, Found, Noted
from mutabot.inside.event_file import EventFile
from mutabot.inside.session import Session
from mutabot.model import Call
from mutabot.model.values.quantity import Value


class CallsTold:
    """Writes down what a session sees of calls, from now on.

    Args:
        session: the session.
        file: where it is told.
        poll: tells what the mutant did.
    """

    def __init__(self, session: Session, file: EventFile, poll: Callable[[], None]) -> None:
        self._session, self._file, self._poll = session, file, poll
        self._found: set[str] = set()
        session.recorder.on_hit = self._hit
        session.on_refused, session.on_live = self._refused, self._is_live
        session.passing.on_end = self._after
        for targets in session.interception.kinds:
            if targets.on_heard is not None:
                targets.on_heard = partial(self._heard, targets.on_heard)

    def tell_found(self) -> None:
        """Tell of targets that were found since the last time."""
        targets = self._session.interception.found - self._found
        if targets:
            self._found |= targets
            for operation in self._session.job.vocabulary.operations:
                if operation.target in targets:
                    self._session.inspection.check_target(operation, self._session.interception)
            self._file.send(Found(targets=tuple(sorted(targets))))

    def _hit(self, site: int, written: Any, read: Any, answer: Any) -> None:
        self._file.send(Called(site, written, read, answer, time.monotonic()))

    def _refused(self, site: int, number: int) -> None:
        self._file.send(Noted(site, number))

    def _is_live(self, site: int) -> None:
        self._file.send(Noted(site))

    def _after(self, call: Call, read: Mapping[str, Value]) -> None:
        self._poll()

    def _heard(self, heard: Callable[[str, Any], None], name: str, message: Any) -> None:
        before = self._session.evidence.said
        heard(name, message)
        if self._session.evidence.said != before:
            self._poll()
