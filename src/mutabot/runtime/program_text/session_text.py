"""The program text of a session: which alternatives stand in it, what they did, and what was seen of it."""

from __future__ import annotations

import ast
import hashlib
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from types import ModuleType
from typing import TYPE_CHECKING, Any

from mutabot.model.events import Event, NotInstrumented, PlacesReached, TextsSeen
from mutabot.model.job import Job
from mutabot.model.mutant import Instrumentation, ProgramText
from mutabot.runtime.event_file import EventWriter
from mutabot.runtime.evidence import Evidence
from mutabot.runtime.program_text import loading
from mutabot.runtime.program_text.foresee import Forms
from mutabot.runtime.program_text.instrument import MismatchError, forms_of, instrumented
from mutabot.runtime.program_text.switches import Alternatives, Sightings

if TYPE_CHECKING:  # not every process makes calls, or forks
    from mutabot.model import Call


class _ChangedError(MismatchError):
    """A file is no longer what the plan was made for."""


class SessionText:
    """Compiles program files with their alternatives, or with witnesses that note which values occur.

    What happens while the program is imported, before any test, holds for every test after it: each test
    counts it as its own. See ``loading.SourceStep``.

    Args:
        root: absolute path of the project.
        instrumentation: what is to stand in the text.
        pipe: where reports go; a copy of a fork server gets its own.
        on_act: told when all active alternatives have changed something in a test.

    Attributes:
        alternatives: the switches of the instrumented text; idle where places are only looked at.
        sightings: what is seen at each place, if places are only looked at; else None.
        imported: files that were instrumented, relative to the root.
        problems: files that were not, with the reason.
    """

    def __init__(
        self,
        root: str,
        instrumentation: Instrumentation,
        pipe: EventWriter | None = None,
        on_act: Callable[[], None] = lambda: None,
    ) -> None:
        texts = instrumentation.texts
        self._places = {place.number: place for text in texts for place in text.places}
        size = max(self._places, default=0)
        self.alternatives = Alternatives(size)
        self.alternatives.activate(*instrumentation.active)
        self.alternatives.forms = cache(self._forms)
        self.alternatives.on_act = self._acted
        self.sightings: Sightings | None = None
        if instrumentation.record:
            variables = {number: place.text for number, place in self._places.items() if place.variable}
            self.sightings = Sightings(size, variables)
        self.pipe = pipe
        self.imported: list[str] = []
        self.problems: dict[str, str] = {}
        self._on_act = on_act
        self._originals: dict[int, ast.expr] = {}
        self._texts = {os.path.realpath(os.path.join(root, text.file)): text for text in texts}
        self._real: Callable[[str], str] = cache(os.path.realpath)
        self._test: str | None = None
        self._refusals: tuple[BaseException, ...] = ()
        self._unknown = False

    @classmethod
    def of(cls, job: Job, pipe: EventWriter, on_act: Callable[[], None]) -> SessionText | None:
        """Instrument the program from now on; None if the job leaves its text alone."""
        if job.instrumentation is None:
            return None
        text = cls(job.root, job.instrumentation, pipe, on_act)
        text.install()
        return text

    def install(self) -> None:
        """Instrument the program's files from now on; files imported before are told as problems."""
        (self.sightings or self.alternatives).install()
        for module in list(sys.modules.values()):
            text = self._text_of(_file_of(module))
            if text is not None:
                self._refuse(text, "it was imported before mutabot could look at it")
        loading.add(self)
        loading.hook_runpy()

    def wants(self, path: str) -> bool:
        """Whether there are alternatives for a file."""
        return self._text_of(path) is not None

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Put the alternatives of a file into its tree. Raises MismatchError if they do not belong there."""
        text = self._text_of(path)
        assert text is not None
        if hashlib.sha256(source).hexdigest() != text.digest:
            raise _ChangedError("it has changed since its mutants were made")
        record = self.sightings is not None
        instrumented(tree, text.places, record=record, originals=self._originals)
        self.imported.append(text.file)

    def give_up(self, path: str, error: Exception) -> None:
        """A file is compiled without its alternatives."""
        text = self._text_of(path)
        assert text is not None
        if text.file in self.imported:
            self.imported.remove(text.file)
        is_known = isinstance(error, _ChangedError)
        self._refuse(text, str(error) if is_known else f"it cannot be instrumented: {error}")

    def _text_of(self, path: str) -> ProgramText | None:
        return self._texts.get(self._real(path))

    def _forms(self, place: int) -> Forms | None:
        original = self._originals.get(place)
        return forms_of(self._places[place], original) if original is not None else None

    def _refuse(self, text: ProgramText, reason: str) -> None:
        self.problems[text.file] = reason
        self._send(NotInstrumented(text.file, reason))

    @property
    def is_mutant(self) -> bool:
        """Whether an alternative is active."""
        return bool(self.alternatives.active)

    def start_test(self, test: str) -> None:
        """A test begins."""
        if self._test is None:  # what happened before any test
            if self.sightings is not None:
                self._tell_reached()
            self.alternatives.keep()
        self._test, self._refusals, self._unknown = test, (), False
        if self.sightings is not None:
            self.sightings.start()
        else:
            self.alternatives.start()

    def watch(
        self, on_place: Callable[[int, frozenset[int]], None], live: Mapping[int, frozenset[int]]
    ) -> None:
        """In a fork parent: tell ``on_place`` which of the ``live`` alternatives of a place are to differ."""
        self.alternatives.on_place = on_place
        self.alternatives.watch(live)

    def end_test(self) -> None:
        """The test is over."""
        if self.sightings is not None:
            self._tell_reached()
        elif self.alternatives.on_place is not None and not self.is_mutant:
            self.alternatives.watch({})  # what is reached between tests belongs to none

    def finish(self, others: Iterable[TextsSeen] = ()) -> None:
        """All tests are over; ``others`` is what was seen in processes below them."""
        if self.sightings is not None:
            others = list(others)
            imported = dict.fromkeys([*self.imported, *(file for one in others for file in one.imported)])
            seen = [*self.sightings.seen(), *(seen for one in others for seen in one.sightings)]
            self._send(TextsSeen(tuple(imported), tuple(seen)))

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
        active, alternatives = self.alternatives.active, self.alternatives
        return Evidence(
            hits=min((alternatives.hits.get(place, 0) for place in active), default=0),
            acted=min(map(alternatives.acted, active), default=0),
            example=next(iter(alternatives.examples.values()), None),
            refusals=self._refusals,
            is_of_text=True,
            is_unknown=self._unknown,
        )

    def _tell_reached(self) -> None:
        assert self.sightings is not None
        self._send(PlacesReached(self._test or "", tuple(sorted(self.sightings.entered))))

    @property
    def has_acted(self) -> bool:
        """Whether all active alternatives have changed something in this test, or before any."""
        return all(map(self.alternatives.acted, self.alternatives.active))

    def _acted(self, place: int) -> None:
        if self.has_acted:
            self._on_act()

    def _send(self, event: Event) -> None:
        if self.pipe is not None:
            self.pipe.send(event)


def _file_of(module: Any) -> str:
    """A module's file; empty if it has none. Modules that are loaded when first used stay asleep."""
    if not isinstance(module, ModuleType):
        return ""
    try:
        file = object.__getattribute__(module, "__dict__").get("__file__")
    except AttributeError:  # libraries of cffi claim to be modules
        return ""
    return file if isinstance(file, str) else ""
