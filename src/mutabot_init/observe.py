"""Observes the calls that a program makes in one run of its tests."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from typing import Any

from mutabot.api.processes import Observed, observe

from .layout import Layout
from .observations import Use, Values, WatchedCallable, WatchedCalls

#: seconds that the tests may take; what was seen by then counts
LIMIT = 180.0
#: what anonymous nodes of ROS 1 have behind their names: another number in each run
_ANONYMOUS = re.compile(r"_\d+_\d{10,}(?=/|$)")


def watch(layout: Layout, limit: float = LIMIT) -> Observed[WatchedCalls]:
    """Run the tests once and observe the program; return what each of its processes observed."""
    return observe(
        layout.root,
        layout.arguments,
        program=[layout.relative(path) for path in layout.program],
        tests=[layout.relative(path) for path in layout.tests],
        observer="mutabot_init.watching.watch:Watch",
        result=WatchedCalls,
        limit=limit,
    )


def merged(processes: Iterable[WatchedCalls]) -> WatchedCalls:
    """Merge processes: one call for each callable and side, one use for each form, name and side."""
    calls: dict[tuple[str, bool, bool], WatchedCallable] = {}
    uses: dict[tuple[Any, ...], Use] = {}
    for seen in processes:
        for call in seen.calls:
            _add_call(calls, call)
        for use in seen.uses:
            _add_use(uses, use)
    return WatchedCalls(list(calls.values()), list(uses.values()))


def _add_call(calls: dict[tuple[str, bool, bool], WatchedCallable], call: WatchedCallable) -> None:
    """Add a process's observation of a callable; the values are those of the first process with any."""
    first = calls.setdefault((call.target, call.of_tests, call.is_set), call)
    if first is not call:
        first.leads_to_names |= call.leads_to_names
        first.reaches |= call.reaches
        first.sites = dict(Counter(first.sites) + Counter(call.sites))


def _add_use(uses: dict[tuple[Any, ...], Use], use: Use) -> None:
    use.name = _ANONYMOUS.sub("_*", use.name)
    known = uses.setdefault((use.form, use.name, use.of_tests, use.is_called_back), use)
    if known is not use:
        known.sites = dict(Counter(known.sites) + Counter(use.sites))
        _merge(known.written, use.written)
        _merge(known.read, use.read)


def _merge(some: Values, others: Values) -> None:
    some.times += others.times
    some.type = some.type or others.type
    for path, part in others.parts.items():
        known = some.parts.setdefault(path, part)
        if known is not part:
            known.count += part.count
            known.values += [value for value in part.values if value not in known.values]
