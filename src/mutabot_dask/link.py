"""The controller's connection to a Dask scheduler: its workers, and the requests to them.

Dask only ships functions and bytes here, and reports who is connected: which worker runs what is decided by
the controller, and so is what the loss of one means.
"""

from __future__ import annotations

import logging
import queue
import socket
import threading
import time
import warnings
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from ipaddress import ip_address
from itertools import count
from typing import Any
from urllib.parse import urlsplit

from mutabot.api.reports import UsageError

try:
    import distributed
except ImportError as error:  # reported in a way that a user can act on
    raise UsageError(
        "--cluster needs the library distributed, which is not installed here: "
        f"pip install 'path/to/mutabot[cluster]' ({error})"
    ) from error

from . import guard
from .settings import ClusterSettings

#: seconds that a scheduler may take to answer
PATIENCE = 10.0
#: seconds between two looks at who is connected; without an answer for that long, the scheduler is gone
_PERIOD, _SILENCE = 0.5, 45.0
#: threads that fetch answers
_FETCHERS = 4
#: how a function of ours is called: one that went as itself would end a worker that cannot import it
_CALL = "exec(code, names := {'given': given}) or names['answer']"
_RAISED = b"!"
#: by which the scheduler reports that no worker can run something
_LOSSES = {"KilledWorker", "NoValidWorkerError"}
#: characters of what a worker says that are shown
_WORDS = 1000
#: answers with what was raised as data: nothing that a worker sends is unpickled here
_CODE = """
try:
    from importlib import import_module
    answer = import_module({!r}).{}(*given)
except BaseException as error:
    text = (str(error).strip().splitlines() or [""])[0][:1000]
    answer = b"!" + (type(error).__name__ + ": " + text).encode("utf-8", "replace")
"""


@dataclass(frozen=True, slots=True)
class WorkerReply:
    """An answer to a request.

    Attributes:
        asked: the number of what was asked.
        data: the answer; None if there is none.
        why: why not.
        is_foreign: whether it is nothing that our functions answer.
    """

    asked: int
    data: bytes | None
    why: str = ""
    is_foreign: bool = False


class Link:
    """A connection to a scheduler.

    Args:
        settings: the cluster.
        address: of its scheduler.

    Attributes:
        replies: answers, as they come.

    Raises UsageError if there is no answer.
    """

    _numbers = count(1)

    def __init__(self, settings: ClusterSettings, address: str) -> None:
        guard.install()
        self.address = address
        self.replies: queue.SimpleQueue[WorkerReply] = queue.SimpleQueue()
        _silence_log()
        self._client = _client(settings, address)
        self._asked: dict[int, Any] = {}
        self._fetching = ThreadPoolExecutor(_FETCHERS, thread_name_prefix="mutabot-fetch")
        self._there: Mapping[str, int] = {}
        self._heard = time.monotonic()
        self._is_closed = threading.Event()
        self._calling = threading.Thread(target=self._update_workers, name="mutabot-roll", daemon=True)
        try:
            self._call_once()
        except Exception as error:
            self.close()
            raise UsageError(_why_not(settings, address, error)) from error
        self._calling.start()

    @property
    def workers(self) -> Mapping[str, int]:
        """The connected workers, with the number of threads of each."""
        return self._there

    @property
    def is_lost(self) -> bool:
        """Whether the scheduler has ended, or cannot be reached."""
        return self._client.status != "running" or time.monotonic() - self._heard > _SILENCE

    def ask(self, worker: str, function: Callable[..., bytes], *arguments: Any) -> int:
        """Let a worker run a function; return the number of its answer."""
        number = next(self._numbers)
        code = _CODE.format(function.__module__, function.__name__)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # large messages are meant
            future = self._client.submit(
                eval, _CALL, {"given": arguments, "code": code},
                key=f"mutabot-{self._client.id}-{number}", pure=False, workers=[worker],
                allow_other_workers=False,
            )  # fmt: skip
        self._asked[number] = future
        future.add_done_callback(lambda done: self._fetch(number, done))
        return number

    def forget(self, *numbers: int) -> None:
        """Cancel requests; they end where they run."""
        futures = [self._asked.pop(number) for number in numbers if number in self._asked]
        if futures and not self.is_lost:
            with suppress(Exception):
                self._client.cancel(futures, force=True)

    def close(self) -> None:
        """Cancel all requests, and disconnect."""
        self.forget(*self._asked)
        self._is_closed.set()
        self._fetching.shutdown(wait=False, cancel_futures=True)
        try:
            self._client.close(timeout=2)
        except Exception:  # such as one that was about to connect again
            self._client.status = (
                "closed"  # else it closes itself once more, and raises, when it is collected
            )
        if self._calling.is_alive():
            self._calling.join(2)

    def _fetch(self, number: int, future: Any) -> None:
        with suppress(RuntimeError):  # it is closed
            self._fetching.submit(self._fetched, number, future)

    def _fetched(self, number: int, future: Any) -> None:
        try:
            reply = _reply(number, future.result(timeout=_SILENCE))
        except Exception as error:  # whatever a worker raises is only reported
            reply = WorkerReply(number, None, one_line(guard.describe(error)), _is_foreign(error))
        if self._asked.pop(number, None) is not None:
            self.replies.put(reply)

    def _update_workers(self) -> None:
        while not self._is_closed.wait(_PERIOD):
            with suppress(Exception):
                self._call_once()

    def _call_once(self) -> None:
        found = self._client.nthreads()
        self._there = {str(address): count for address, count in found.items() if type(count) is int}
        self._heard = time.monotonic()


def _reply(number: int, found: Any) -> WorkerReply:
    if type(found) is not bytes:
        return WorkerReply(number, None, f"it answered with {guard.describe(found)}", is_foreign=True)
    if found.startswith(_RAISED):
        return WorkerReply(number, None, one_line(found[1:_WORDS].decode("utf-8", "replace")))
    return WorkerReply(number, found)


def _is_foreign(error: Exception) -> bool:
    """Return whether a worker's error came neither from our functions, which return data, nor its loss."""
    return isinstance(error, guard.Placeholder) and error.kind not in _LOSSES


def one_line(text: str) -> str:
    """Return a worker's message as one line without control characters."""
    return "".join(character if character.isprintable() else "�" for character in text[:_WORDS])


def _client(settings: ClusterSettings, address: str) -> Any:
    try:
        security = _security(settings, address)
        open_client: Any = distributed.Client
        return open_client(address, security=security, timeout=PATIENCE, set_as_default=False, name="mutabot")
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        raise UsageError(_why_not(settings, address, error)) from error


def _security(settings: ClusterSettings, address: str) -> Any:
    if not address.startswith("tls://"):
        if settings.files:
            raise ValueError("it is not encrypted, though there are certificate files")
        return None
    security: Any = distributed.Security
    return security(
        tls_ca_file=settings.ca, tls_client_cert=settings.cert, tls_client_key=settings.key,
        require_encryption=True,
    )  # fmt: skip


def is_private(address: str) -> bool:
    """Return whether a connection to this address is encrypted, or stays on this machine."""
    if address.startswith("tls://"):
        return True
    try:
        places = socket.getaddrinfo(urlsplit(address).hostname, None, type=socket.SOCK_STREAM)
    except (OSError, ValueError):
        return False
    return all(ip_address(str(place[0]).partition("%")[0]).is_loopback for *_, place in places)


def _why_not(settings: ClusterSettings, address: str, error: Exception) -> str:
    text = str(error).splitlines()[0] if str(error) else type(error).__name__
    hint = "is `dask scheduler` running there, and is the port right?"
    if address.startswith("tls://") or settings.files:
        hint = f"{hint} Do the certificate files belong to it ({', '.join(settings.files) or 'none given'})?"
    return f"no scheduler answers at {address}: {text}; {hint}"


def _silence_log() -> None:
    """Silence Dask's log: mutabot reports the same events itself."""
    for name in (
        "distributed",
        *(name for name in logging.root.manager.loggerDict if name.startswith(("distributed.", "tornado"))),
    ):
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
