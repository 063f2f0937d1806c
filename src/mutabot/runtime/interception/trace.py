"""The trace: which sites a test reaches, in which order, with which values.

Whose call it is, and exactly where it stands: from the frames of the running program.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from types import CodeType, FrameType
from typing import TYPE_CHECKING, Any

from mutabot.evidence.recording import RecordedCall
from mutabot.languages.python import FRONT_END as PYTHON
from mutabot.languages.registry import front_ends
from mutabot.model import Call, Reply, Role, Span
from mutabot.model.answer import NotKeptError, keep
from mutabot.model.codec import is_plain
from mutabot.model.events import TRACE_LIMIT, SiteSeen
from mutabot.model.operation import Form
from mutabot.runtime.executed_text import executed, original_code
from mutabot.runtime.interception.adapter import SiteCall, call_context
from mutabot.runtime.interception.frames import borders, is_within_border
from mutabot.runtime.paths import forget_with, is_below, real_path

if TYPE_CHECKING:
    from mutabot.model.mutant import Extent
    from mutabot.runtime.targets.target import CallPlace

#: stands for an answer that cannot be kept and that the program waits for: it never comes
LOST = {"pending": ""}
#: modules whose frames run the tasks of an event loop
_LOOPS = frozenset({"asyncio.events", "asyncio.base_events", "asyncio.runners", "trio._core._run"})
#: stands for the definition of a function, beside the numbers of its instructions
_DEFINITION = -2
#: of the calls of a trace, how many are recorded with their times
_KEPT = 2000


@dataclass(slots=True)
class Recorder:
    """The sites of the session, and the trace of the running test.

    Attributes:
        on_site: called with each site when it is first reached.
        answers: notes what commands answered, in the baseline; None in all other sessions.
        trace: hits of the running test: site index, written values, read values, note of the answer. Beyond
            the first ``TRACE_LIMIT`` hits, the first one of each site.
        truncated: whether hits were left out of the trace.
        sites: all sites reached so far, in the order of their indexes.
        on_hit: called with each hit, as it is in the trace; None while not wanted.
        clock: returns the time, s; None where it is not noted.
        when: when each hit of the trace began and ended, s.
        began: when the call that is under way began, s.
    """

    on_site: Callable[[SiteSeen], None]
    answers: Answers | None = None
    trace: list[tuple[Any, ...]] = field(default_factory=list)
    truncated: bool = False
    sites: list[SiteSeen] = field(default_factory=list)
    on_hit: Callable[[int, Any, Any, Any], None] | None = None
    clock: Callable[[], float | None] | None = None
    when: list[tuple[float | None, float | None]] = field(default_factory=list)
    began: float | None = None
    _indexes: dict[SiteSeen, int] = field(default_factory=dict)
    _reached: set[int] = field(default_factory=set)

    def start(self) -> None:
        """Begin a new test."""
        self.trace, self.when = [], []
        self.truncated = False
        self._reached.clear()
        if self.answers is not None:
            self.answers.start()

    def record(self, made: SiteCall, reply: Reply | None, began: float | None) -> None:
        """Record a call that has ended; ``reply`` is the robot's last reply, None if the call raised."""
        call = made.call
        index = self.index_of(seen_by(made))
        # a program that polls makes thousands of calls before it comes to other sites
        if len(self.trace) >= TRACE_LIMIT and index in self._reached:
            self.truncated = True
            return
        self._reached.add(index)
        answer = self.answers.note(index, call, reply) if self.answers is not None else None
        read = reply.values if reply is not None else {}
        self.trace.append((index, _frozen(call.values), _frozen(read), answer))
        self.when.append((began, self.clock() if self.clock is not None else None))
        if self.on_hit is not None:
            self.on_hit(*self.trace[-1])

    def index_of(self, seen: SiteSeen) -> int:
        """Return the index of a site that was reached here or in another process."""
        key = replace(seen, index=-1)
        index = self._indexes.get(key)
        if index is None:
            index = self._indexes[key] = len(self._indexes)
            self.sites.append(replace(seen, index=index))
            self.on_site(self.sites[-1])
        return index

    def recorded_calls(self) -> list[RecordedCall]:
        """Return the recorded calls of the running test with their times."""
        return [
            self.recorded_call(index, written, read, began, ended)
            for (index, written, read, _), (began, ended) in zip(self.trace[:_KEPT], self.when, strict=False)
        ]

    def recorded_call(
        self, index: int, written: Any, read: Any, began: float | None, ended: float | None = None
    ) -> RecordedCall:
        """Return one call at the site of this index; ``ended`` is ``began`` if it is not known."""
        site = self.sites[index]
        place = f"{site.span.file}:{site.span.line}"
        role = Role.ORACLE if site.oracle else Role.PROGRAM
        ended = began if ended is None else ended
        return RecordedCall(began, ended, site.operation, place, site.pattern, written, read, role)


def seen_by(made: SiteCall) -> SiteSeen:
    """Return the event of a site whose index is not known."""
    (span, role), call = made.site, made.call
    pattern = call.pattern.text if call.pattern is not None else None
    return SiteSeen(
        -1, span, call.operation.target, pattern, role is Role.ORACLE, made.is_direct, made.stands_in
    )


@dataclass(slots=True)
class Answers:
    """The answers of the running test, for the trace.

    Plain values are noted as they are. Of others, the first at each site is noted by value, and later ones
    only by whether they are the same: what the robot answered first is all that is needed.

    Attributes:
        handles: classes that are part of the robot API.
    """

    handles: Collection[str] = ()
    _first: dict[int, Any] = field(default_factory=dict)
    _varying: set[int] = field(default_factory=set)

    def start(self) -> None:
        """Begin a new test."""
        self._first.clear()
        self._varying.clear()

    def note(self, site: int, call: Call, reply: Reply | None) -> Any:
        """Return the note about an answer at a site; ``reply`` is None if the call raised."""
        if reply is None:
            return {"raised": True}
        if is_plain(reply.payload):
            self._first.setdefault(site, reply.payload)
            return reply.payload
        if site in self._varying:
            return {"other": True}
        data = self._data(call, reply.payload)
        if site not in self._first:
            self._first[site] = data
            return data
        if data == self._first[site] and "kept" in data:
            return {"same": True}
        self._varying.add(site)
        return {"other": True}

    def _data(self, call: Call, answer: Any) -> dict[str, Any]:
        try:
            return {"kept": keep(answer, call_context(call), self.handles)}
        except NotKeptError as error:
            return {"kept": LOST} if _can_be_lost(call) else {"opaque": str(error)}
        except Exception as error:  # objects of the user's may do anything when they are looked at
            return {"opaque": f"{type(answer).__qualname__}, which raises {error!r}"}


def _can_be_lost(call: Call) -> bool:
    """Return whether it sends the goal of an action to a server that may never answer."""
    named, means = call.operation.named, call.payload.where.means
    is_goal = named is not None and named.form is Form.GOAL
    return is_goal and means is not None and means.lost is not None


def _frozen(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return copies of values whose lists and arrays a program may change later."""
    found: dict[str, Any] = {
        name: list(value) if isinstance(value, list) else value for name, value in values.items()
    }
    return {
        name: value.tolist() if hasattr(type(value), "tolist") else value for name, value in found.items()
    }


class Locator:
    """Finds the nearest frame in the program or the oracle.

    Args:
        root: absolute path of the project.
        program, oracle: files and folders, relative to the root.

    Attributes:
        role: returns whose file it is; None for files of neither.
    """

    def __init__(self, root: str, program: tuple[str, ...], oracle: tuple[str, ...]) -> None:
        self._root = os.path.realpath(root)
        # Longer paths first: a file named as oracle inside a program folder is oracle.
        named = [*((path, Role.PROGRAM) for path in program), *((path, Role.ORACLE) for path in oracle)]
        places = ((os.path.realpath(os.path.join(self._root, path)), role) for path, role in named)
        self._places = sorted(places, key=lambda place: -len(place[0]))
        find_role = cache(self._find_role)
        self.role: Callable[[str], Role | None] = find_role
        forget_with(find_role.cache_clear)
        # By the identity of code: the code of equal functions in two files is equal, though they are two
        # places. It is kept beside its span, so that no other code can get its address.
        self._spans: dict[tuple[int, int], tuple[Span, CodeType]] = {}
        # every other frame is Python's: asking its front end for each would cost each call
        self._interpreted = [front_end for front_end in front_ends() if front_end is not PYTHON]

    def locate(self, frame: FrameType | None, *, in_operation: bool = False) -> CallPlace | None:
        """Return span and role of the call that runs in ``frame`` or the nearest frame around it.

        None if an operation makes the call: its frame is nearer. ``in_operation``: whether this context is
        that of an operation, which may have begun a task of its own. What runs the loop is no part of it.
        """
        interpreted, around_loop = self._interpreted, False
        while frame is not None:
            code = frame.f_code
            if id(code) in borders:
                return None
            found = self._in_interpreter(frame) if interpreted else None
            role = self.role(code.co_filename) if found is None else None
            if role is None and executed:
                code = original_code(code)
                role = self.role(code.co_filename)
            if role is not None:
                found = (self._span(code, frame.f_lasti), role)
            if found is not None:
                return found if not around_loop or is_within_border(frame) else None
            around_loop = around_loop or (in_operation and frame.f_globals.get("__name__") in _LOOPS)
            frame = frame.f_back
        return None

    def locate_definition(self, code: CodeType) -> CallPlace | None:
        """Return the span and role of a function's definition; None outside of program and oracle."""
        code = original_code(code)
        role = self.role(code.co_filename)
        return (self._span(code, _DEFINITION), role) if role is not None else None

    def relative(self, filename: str) -> str:
        """Return the path relative to the root, with forward slashes."""
        return os.path.relpath(real_path(filename), self._root).replace(os.sep, "/")

    def is_of_project(self, filename: str) -> bool:
        """Return whether a file is the user's own: below the root and not installed."""
        relative = self.relative(filename)
        return not (relative.startswith("..") or "site-packages" in relative or filename.startswith("<"))

    def _find_role(self, filename: str) -> Role | None:
        path = real_path(filename)
        return next((role for place, role in self._places if is_below(path, place)), None)

    def _in_interpreter(self, frame: FrameType) -> CallPlace | None:
        """Return the site in a frame of an interpreter that runs a file of the program or the oracle."""
        for front_end in self._interpreted:
            filename = front_end.file_of(frame)
            role = self.role(filename) if filename is not None else None
            if filename is not None and role is not None:
                return self._span_at(filename, *front_end.position_of(frame)), role
        return None

    def _span(self, code: CodeType, instruction: int) -> Span:
        """Return the span of an instruction of the code, cached."""
        key = (id(code), instruction)
        known = self._spans.get(key)
        if known is None:
            is_call = instruction != _DEFINITION
            found = PYTHON.position_at(code, instruction) if is_call else PYTHON.definition_of(code)
            known = self._spans[key] = (self._span_at(code.co_filename, *found), code)
        return known[0]

    def _span_at(self, filename: str, extent: Extent, function: str) -> Span:
        return Span(self.relative(filename), *extent, function)
