"""One plain run of the tests, watched: the calls that the program really makes."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from mutabot.execution.processes import command, kill_group
from mutabot.extensions import libraries, told_to_processes
from mutabot.model.codec import from_data

from .layout import Layout
from .watched import WATCH_VARIABLE, Use, Values, WatchedCallable, WatchedCalls

#: seconds that the tests may take; what was seen by then counts
LIMIT = 180.0
#: what anonymous nodes of ROS 1 have behind their names: another number in each run
_ANONYMOUS = re.compile(r"_\d+_\d{10,}(?=/|$)")


def observe(layout: Layout, limit: float = LIMIT) -> WatchedCalls:
    """Run the tests once and watch the program."""
    with TemporaryDirectory(ignore_cleanup_errors=True) as name:  # nodes may still write to their logs
        folder = Path(name)
        order, output, log = folder / "watch.json", folder / "seen.json", folder / "log.txt"
        order.write_text(json.dumps(_order(layout, output)), encoding="utf-8")
        own = ["-p", "mutabot_init.watching.plugin", "--assert=plain"]
        words = [*command(layout.arguments, folder), *own]
        overdue = _wait(words, layout.root, order, log, limit)
        said = log.read_text(encoding="utf-8", errors="replace")
        seen = _read(output)
        if overdue:
            seen.trouble = f"the tests took longer than {limit:.0f} s: only what was seen by then is known"
        elif not seen.outcomes:
            seen.trouble = "; ".join(seen.problems[:3]) or _said(said)
        return seen


def _order(layout: Layout, output: Path) -> dict[str, Any]:
    names = {kind: {os.path.realpath(path): layout.relative(path) for path in getattr(layout, kind)}
             for kind in ("program", "tests")}  # fmt: skip
    brought = {"extensions": told_to_processes(), "libraries": list(libraries())}
    return {**names, **brought, "root": str(layout.root), "output": str(output)}


def _wait(words: Sequence[str], root: Path, order: Path, log: Path, limit: float) -> bool:
    """Run pytest; whether it was ended because it took too long."""
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1", WATCH_VARIABLE: str(order)}
    with (
        log.open("wb") as file,
        subprocess.Popen(
            words, cwd=root, env=environment, stdin=subprocess.DEVNULL, stdout=file,
            stderr=subprocess.STDOUT, start_new_session=True,
        ) as process,
    ):  # fmt: skip
        try:
            process.wait(limit)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)  # as a person would: pytest ends in an orderly way
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(5.0)
            return True
        finally:
            kill_group(process.pid)
            process.wait()
    return False


def _read(output: Path) -> WatchedCalls:
    try:
        return merged(from_data(WatchedCalls, json.loads(output.read_text(encoding="utf-8"))))
    except (OSError, ValueError, TypeError, KeyError):
        return WatchedCalls()


def merged(seen: WatchedCalls) -> WatchedCalls:
    """One call for each callable and side, one use for each form, name and side, whichever process saw it."""
    calls: dict[tuple[str, bool], WatchedCallable] = {}
    for call in seen.calls:  # of what several processes saw of a callable, the first one's values
        first = calls.setdefault((call.target, call.of_tests), call)
        if first is not call:
            first.leads_to_names |= call.leads_to_names
            first.sites = dict(Counter(first.sites) + Counter(call.sites))
    uses: dict[tuple[Any, ...], Use] = {}
    for use in seen.uses:
        use.name = _ANONYMOUS.sub("_*", use.name)
        known = uses.setdefault((use.form, use.name, use.of_tests, use.is_called_back), use)
        if known is not use:
            known.sites = dict(Counter(known.sites) + Counter(use.sites))
            _merge(known.written, use.written)
            _merge(known.read, use.read)
    return replace(seen, calls=list(calls.values()), uses=list(uses.values()))


def _merge(some: Values, others: Values) -> None:
    some.times += others.times
    some.type = some.type or others.type
    for path, part in others.parts.items():
        known = some.parts.setdefault(path, part)
        if known is not part:
            known.count += part.count
            known.values += [value for value in part.values if value not in known.values]


def _said(log: str) -> str:
    """What pytest said last that tells something."""
    lines = [line.strip() for line in log.splitlines() if line.strip()]
    telling = [line for line in lines if re.search(r"error|Error|no tests|No module", line)]
    return (telling or lines or ["pytest said nothing"])[-1][:300]
