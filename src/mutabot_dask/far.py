"""What Dask's workers run for a campaign. Each function takes bytes of JSON, and gives such bytes."""

from __future__ import annotations

import os
import shutil
import socket
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from mutabot.campaign.reuse.keys import versions
from mutabot.campaign.workers.remains import OWNER, end_abandoned

from .session import Session, Unwanted
from .store import Store
from .unit import Introduction, Unit

#: seconds between two looks for what is idle
_PERIOD = 20.0
#: seconds that a folder may be without an owner, since it is just being made
_YOUNG = 60.0
#: the answer of functions that have nothing to say
TAKEN = b"{}"
_sessions: dict[str, Session] = {}
_stores: dict[Path, Store] = {}


def introduce(digest: str, inner: str) -> bytes:
    """Say who this worker is, and whether it has a bundle. An empty digest asks for none."""
    has = bool(digest) and _store().has(digest)
    if has:
        _clear_up(_store().place(digest) / inner / ".mutabot")
    return Introduction(versions(), has).data()


def receive(digest: str, index: int, count: int, part: bytes) -> bytes:
    """Take a part of a bundle."""
    store = _store()
    store.hold(digest)
    store.take(digest, index, count, part)
    return TAKEN


def run_unit(data: bytes) -> bytes:
    """Run a unit."""
    unit = Unit.of(data)
    digest = unit.ground.digest
    session = _sessions.get(digest)
    if session is None or session.ground != unit.ground:
        leave("")
        session = _sessions[digest] = Session(_store().place(digest), unit.ground)
        _watch(session)
    return session.answer(unit, _look_of(_worker()))


def leave(digest: str) -> bytes:
    """Keep nothing of a campaign; ``digest`` names the bundle that goes as well."""
    for session in list(_sessions.values()):
        session.close()
    _sessions.clear()
    if digest:
        _store().leave(digest)
    return TAKEN


def _worker() -> Any:
    from distributed import get_worker  # noqa: PLC0415  # only workers have it for sure

    return get_worker()


def _store() -> Store:
    """The bundles of this machine, beside Dask's own folders."""
    folder = (
        Path(_worker().local_directory).resolve().parent / f"mutabot-{os.getuid()}-{socket.gethostname()}"
    )
    if folder not in _stores:
        _stores[folder] = Store(folder)
    return _stores[folder]


def _clear_up(home: Path) -> None:
    """End and remove what workers of this machine have left that were killed."""
    end_abandoned(home)
    for folder in home.glob("work-*"):
        with suppress(OSError):
            if not (folder / OWNER).exists() and time.time() - folder.stat().st_mtime > _YOUNG:
                shutil.rmtree(folder, ignore_errors=True)


def _look_of(worker: Any) -> Any:
    """What raises Unwanted once the unit that runs now is wanted no more."""
    key = worker.get_current_task()

    def look() -> None:
        task = worker.state.tasks.get(key)
        is_closing = worker.status.name in {"closing", "closed", "failed", "stopping"}
        if is_closing or task is None or task.state != "executing":
            raise Unwanted

    return look


def _watch(session: Session) -> None:
    """Let a session that has become idle keep no processes."""

    def watch() -> None:
        if session in _sessions.values():
            session.close_if_idle()
            _later(watch)

    _later(watch)


def _later(action: Any) -> None:
    timer = threading.Timer(_PERIOD, action)
    timer.daemon = True
    timer.start()
