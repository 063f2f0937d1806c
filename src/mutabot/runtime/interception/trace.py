"""The trace: which sites a test hits, in which order, with which values.

Whose call it is, and exactly where it stands: from the frames of the running program.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from types import CodeType, FrameType
from typing import Any

from mutabot.evidence.recording import Told
from mutabot.languages.front_end import Position, front_ends
from mutabot.languages.python import FRONT_END as PYTHON
from mutabot.model import Role, Span
from mutabot.model.events import TRACE_LIMIT, SiteSeen
from mutabot.runtime.interception.adapter import Answers, Returned

#: of the calls of a trace, how many are recorded with their times
_TOLD = 2000


def _no_clock() -> float | None:
    return None


@dataclass(slots=True)
class Recorder:
    """Sites of the session, and the trace of the running test.

    Attributes:
        on_site: told about each site when it is first reached.
        answers: notes what commands answered, in the baseline; None in all other sessions.
        trace: hits of the running test: site index, written values, read values, note of the answer.
        truncated: whether hits were left out of the trace.
        sites: all sites reached so far, in the order of their indexes.
        on_hit: told of each hit, as it is in the trace; None while nobody asks.
        clock: tells the time, s; None where it is not noted.
        when: when each hit of the trace began and ended, s.
        began: when the call that is under way began, s.
    """

    on_site: Callable[[SiteSeen], None]
    answers: Answers | None = None
    trace: list[tuple[Any, ...]] = field(default_factory=list)
    truncated: bool = False
    sites: list[SiteSeen] = field(default_factory=list)
    on_hit: Callable[[int, Any, Any, Any], None] | None = None
    clock: Callable[[], float | None] = _no_clock
    when: list[tuple[float | None, float | None]] = field(default_factory=list)
    began: float | None = None
    _indexes: dict[SiteSeen, int] = field(default_factory=dict)

    def start(self) -> None:
        """A new test begins."""
        self.trace, self.when = [], []
        self.truncated = False
        if self.answers is not None:
            self.answers.start()

    def hit(
        self,
        span: Span,
        role: Role,
        operation: str,
        pattern: str | None,
        written: Mapping[str, Any],
        read: Mapping[str, Any],
        returned: Returned | None,
        began: float | None = None,
        *,
        is_direct: bool = False,
    ) -> None:
        """One call at a site has been made; ``returned`` is None if it raised, ``began`` is in s."""
        if len(self.trace) >= TRACE_LIMIT:
            self.truncated = True
            return
        index = self.index_of(SiteSeen(-1, span, operation, pattern, role is Role.ORACLE, is_direct))
        answer = self.answers.note(index, returned) if self.answers is not None else None
        self.trace.append((index, _frozen(written), _frozen(read), answer))
        self.when.append((began, self.clock()))
        if self.on_hit is not None:
            self.on_hit(*self.trace[-1])

    def index_of(self, seen: SiteSeen) -> int:
        """The index of a site that was reached here or, under another index, in another process."""
        key = replace(seen, index=-1)
        index = self._indexes.get(key)
        if index is None:
            index = self._indexes[key] = len(self._indexes)
            self.sites.append(replace(seen, index=index))
            self.on_site(self.sites[-1])
        return index

    def told(self) -> list[Told]:
        """The calls of the running test with their times, as far as they are recorded."""
        return [
            self.told_of(index, written, read, began, ended)
            for (index, written, read, _), (began, ended) in zip(self.trace[:_TOLD], self.when, strict=False)
        ]

    def told_of(
        self, index: int, written: Any, read: Any, began: float | None, ended: float | None = None
    ) -> Told:
        """One call at the site of this index; ``ended`` is ``began`` where that is not known."""
        site = self.sites[index]
        place = f"{site.span.file}:{site.span.line}"
        role = Role.ORACLE if site.oracle else Role.PROGRAM
        ended = began if ended is None else ended
        return Told(began, ended, site.operation, place, site.pattern, written, read, role)

    def sites_of(self, trace: Iterable[Any]) -> tuple[SiteSeen, ...]:
        """The sites that a trace refers to; those of processes below the tests are in it as well."""
        return tuple(self.sites[index] for index in sorted({hit[0] for hit in trace}))


def _frozen(values: Mapping[str, Any]) -> dict[str, Any]:
    """The values as they are now: a program may change its lists and arrays later."""
    return {
        name: value.tolist()
        if hasattr(value, "tolist")
        else list(value)
        if isinstance(value, list)
        else value
        for name, value in values.items()
    }


class Locator:
    """Finds the nearest frame that lies in the configured program or oracle paths.

    Args:
        root: absolute path of the project.
        program, oracle: files and folders, relative to the root.
    """

    def __init__(self, root: str, program: tuple[str, ...], oracle: tuple[str, ...]) -> None:
        self._root = os.path.realpath(root)
        # Longer paths first: a file named as oracle inside a program folder is oracle.
        places = [(self._absolute(path), Role.PROGRAM) for path in program]
        places += [(self._absolute(path), Role.ORACLE) for path in oracle]
        self._places = sorted(places, key=lambda place: -len(place[0]))
        self._roles: dict[str, Role | None] = {}
        # By the identity of code: the code of equal functions in two files is equal, though they are two
        # places. It is kept beside its span, so that no other code can get its address.
        self._spans: dict[tuple[int, int], tuple[Span, CodeType]] = {}
        # every other frame is Python's: asking its front end for each would cost each call
        self._interpreted = [one for one in front_ends() if one is not PYTHON]
        self._real: dict[str, str] = {}

    def locate(self, frame: FrameType | None) -> tuple[Span, Role] | None:
        """Span and role of the call that is running in ``frame`` or the nearest frame around it."""
        interpreted = self._interpreted
        while frame is not None:
            if interpreted:
                found = self._in_interpreter(frame)
                if found is not None:
                    return found
            role = self.role(frame.f_code.co_filename)
            if role is not None:
                return self._span(frame), role
            frame = frame.f_back
        return None

    def locate_definition(self, code: CodeType) -> tuple[Span, Role] | None:
        """Span and role of a function's definition; None for one of neither the program nor the oracle."""
        role = self.role(code.co_filename)
        if role is None:
            return None
        return self._span_at(code.co_filename, PYTHON.definition_of(code)), role

    def role(self, filename: str) -> Role | None:
        """Whose file it is; None for files of neither."""
        try:
            return self._roles[filename]
        except KeyError:
            role = self._roles[filename] = self._find_role(self.real(filename))
            return role

    def relative(self, filename: str) -> str:
        """The path relative to the root, with forward slashes."""
        return os.path.relpath(self.real(filename), self._root).replace(os.sep, "/")

    def real(self, filename: str) -> str:
        """The path without symbolic links; looked up once."""
        path = self._real.get(filename)
        if path is None:
            path = self._real[filename] = os.path.realpath(filename)
        return path

    def _find_role(self, path: str) -> Role | None:
        for place, role in self._places:
            if path == place or path.startswith(place + os.sep):
                return role
        return None

    def _absolute(self, path: str) -> str:
        return os.path.realpath(os.path.join(self._root, path))

    def _in_interpreter(self, frame: FrameType) -> tuple[Span, Role] | None:
        """The same for a frame in which an interpreter carries out a file of the program or the oracle."""
        for front_end in self._interpreted:
            filename = front_end.file_of(frame)
            role = self.role(filename) if filename is not None else None
            if filename is not None and role is not None:
                return self._span_at(filename, front_end.position_of(frame)), role
        return None

    def _span(self, frame: FrameType) -> Span:
        code = frame.f_code
        key = (id(code), frame.f_lasti)
        known = self._spans.get(key)
        if known is None:
            span = self._span_at(code.co_filename, PYTHON.position_of(frame))
            known = self._spans[key] = (span, code)
        return known[0]

    def _span_at(self, filename: str, position: Position) -> Span:
        return Span(self.relative(filename), *position.extent, position.function)
