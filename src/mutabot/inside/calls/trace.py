"""The trace: which sites a test hits, in which order, with which values."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from mutabot.border.events import TRACE_LIMIT, SiteSeen
from mutabot.evidence.recording import Told
from mutabot.model import Role, Span

from .answers import Answers, Returned

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
