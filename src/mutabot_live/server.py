"""The server: only for this machine, with a secret address, and for no page of another site.

A page of another site cannot read anything here: it does not know the token, its name in ``Host`` is not
this machine's (which also stops names that are made to lead here), and its ``Origin`` is not ours.

Browsers get the last state, and notes. There is no queue for each: a browser that asks gets what is new since
he last asked, and a state only once it is the last: a browser that is slow misses states in between, and
holds up no other.
"""

from __future__ import annotations

import contextlib
import hmac
import io
import json
import re
import secrets
import select
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from mutabot.api.reports import UsageError

from .pages import Page, Pages

#: notes that are kept for those who come later
_NOTES = 100
#: browsers at a time
_MOST = 32


@dataclass(frozen=True, slots=True)
class LiveEvent:
    """An event sent to browsers.

    Attributes:
        number: later events have higher ones.
        kind: ``state`` or ``note``.
        data: what JSON can hold.
    """

    number: int
    kind: str
    data: Any


class LiveFeed:
    """The events of one campaign; any thread may add and read."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._number = 0
        self._state: LiveEvent | None = None
        self._notes: deque[LiveEvent] = deque(maxlen=_NOTES)
        self._readers = 0
        self._left = float("-inf")
        self._is_closed = False

    def put(self, state: Mapping[str, Any]) -> None:
        """Add a new state."""
        with self._changed:
            self._state = self._next("state", dict(state))
            self._changed.notify_all()

    def note(self, text: str) -> None:
        """Add a note to the user."""
        with self._changed:
            self._notes.append(self._next("note", text))
            self._changed.notify_all()

    def close(self) -> None:
        """Close the feed: no further events are sent."""
        with self._changed:
            self._is_closed = True
            self._changed.notify_all()

    def after(self, number: int, seconds: float) -> list[LiveEvent]:
        """Return the events after a given one, waiting up to ``seconds``; all after an unknown number."""
        with self._changed:
            if number > self._number:  # it is from another feed
                number = 0
            self._changed.wait_for(lambda: self._is_closed or self._since(number), seconds)
            return self._since(number)

    @property
    def is_closed(self) -> bool:
        """Whether no further events will come."""
        return self._is_closed

    @contextmanager
    def reader(self) -> Iterator[bool]:
        """Count a listening browser in this context; yield False if there are too many."""
        with self._changed:
            is_free = self._readers < _MOST
            self._readers += is_free
        try:
            yield is_free
        finally:
            with self._changed:
                self._readers -= is_free
                self._left = time.monotonic()

    def is_listened_to(self, seconds: float) -> bool:
        """Return whether a browser listens, or did within the last ``seconds``: it may be reloading."""
        with self._changed:
            return self._readers > 0 or time.monotonic() - self._left < seconds

    def _next(self, kind: str, data: Any) -> LiveEvent:
        self._number += 1
        return LiveEvent(self._number, kind, data)

    def _since(self, number: int) -> list[LiveEvent]:
        last = [self._state] if self._state is not None else []
        return sorted((note for note in [*self._notes, *last] if note.number > number), key=_number)


def _number(event: LiveEvent) -> int:
    return event.number


HOST = "127.0.0.1"
#: what this machine is called here; the port is another one behind a tunnel
_NAMES = re.compile(r"(localhost|127\.0\.0\.1|\[::1\])(:[0-9]{1,5})?", re.IGNORECASE)
#: seconds: for one request or one write; between two signs of life; between two looks; between two states
_PATIENCE, _HEARTBEAT, _TICK, _REST = 30.0, 15.0, 1.0, 0.2
#: connections at a time; further ones are closed. Limits of a whole request, in seconds and bytes
MOST, WITHIN, _LARGEST = 64, 10.0, 1 << 16
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}

PageCommands = Mapping[str, Callable[[], None]]


class Server:
    """Serves pages and events, and takes commands, in its own threads. Raises UsageError without its port.

    Args:
        port: of this machine; 0 for any that is free.
        commands: what to do, by name.

    Attributes:
        address: where a browser finds it. Who knows it may see the report, and give commands.
    """

    def __init__(self, pages: Pages, feed: LiveFeed, commands: PageCommands, port: int = 0) -> None:
        token = secrets.token_urlsafe(24)
        try:
            self._server = _Server(port, token, pages, feed, commands)
        except OSError as error:
            raise UsageError(
                f"--port {port} of {HOST} cannot be had: {error.strerror}; without --port a free one is taken"
            ) from error
        self.address = f"http://{HOST}:{self._server.server_address[1]}/{token}/"
        self._thread = threading.Thread(
            target=self._server.serve_forever, kwargs={"poll_interval": 0.1}, name="mutabot-page", daemon=True
        )
        self._thread.start()

    def close(self) -> None:
        """Stop taking requests; streams end with their feed."""
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()


class _Server(ThreadingHTTPServer):
    """The HTTP server; connections beyond ``MOST`` are closed to save descriptors and memory."""

    daemon_threads = True
    block_on_close = False  # a browser that does not read holds up no other
    request_queue_size = MOST

    def __init__(self, port: int, token: str, pages: Pages, feed: LiveFeed, commands: PageCommands) -> None:
        self.token, self.pages, self.feed, self.commands = token.encode(), pages, feed, commands
        self._places = threading.BoundedSemaphore(MOST)
        super().__init__((HOST, port), _PageHandler)

    def get_request(self) -> tuple[socket.socket, Any]:
        """Return the next connection; if none can be accepted now, wait before the next attempt."""
        try:
            return super().get_request()
        except OSError:
            time.sleep(_REST)
            raise

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer a request in a thread of its own, or reject it."""
        if not self._places.acquire(blocking=False):
            self.shutdown_request(request)
            return
        try:
            super().process_request(request, client_address)
        except BaseException:
            self._places.release()
            raise

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Handle a request in a thread of its own."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._places.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore the error of a browser that has gone or is too slow; the terminal is the campaign's."""


class _BoundedRequest(io.RawIOBase):
    """The request of a browser, limited in time and size."""

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self._until = time.monotonic() + WITHIN
        self._left = _LARGEST

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        """Read into a buffer. Raises TimeoutError if the time is up, which ends the connection."""
        left = self._until - time.monotonic()
        if left <= 0:
            raise TimeoutError
        self._connection.settimeout(left)
        try:
            count = self._connection.recv_into(memoryview(buffer)[: self._left])
        finally:
            self._connection.settimeout(_PATIENCE)
        self._left -= count
        return count


class _PageHandler(BaseHTTPRequestHandler):
    server: _Server
    timeout = _PATIENCE
    server_version, sys_version = "mutabot", ""

    def setup(self) -> None:
        """Limit the time and size of reading a request."""
        super().setup()
        self.rfile.close()
        self.rfile = io.BufferedReader(_BoundedRequest(self.connection))

    def do_GET(self) -> None:
        """Serve a page, data, or the stream of events."""
        path = self._path()
        if path is None:
            return
        if path == "events":
            self._stream()
            return
        try:
            page = self.server.pages.get(path)
        except Exception as error:  # whatever is wrong with the page, the campaign goes on
            self._refuse(HTTPStatus.INTERNAL_SERVER_ERROR, f"{type(error).__name__}: {error}")
            return
        if page is None:
            self._refuse(HTTPStatus.NOT_FOUND, "there is no such page")
        else:
            self._send(page)

    def do_POST(self) -> None:
        """Accept a command, only from our own page."""
        path = self._path()
        if path is None:
            return
        command = self.server.commands.get(path)
        if command is None:
            self._refuse(HTTPStatus.NOT_FOUND, "there is no such command")
        elif (self.headers.get("Origin") or "").lower() != f"http://{self.headers['Host']}".lower():
            self._refuse(HTTPStatus.FORBIDDEN, "commands come from this page alone")
        else:
            command()
            self._begin(HTTPStatus.NO_CONTENT)

    def _path(self) -> str | None:
        """Return the requested path, without the token; None if the request was refused."""
        hosts = self.headers.get_all("Host") or []
        if len(hosts) != 1 or not _NAMES.fullmatch(hosts[0]):
            self._refuse(HTTPStatus.MISDIRECTED_REQUEST, "open this page as localhost or 127.0.0.1")
            return None
        token, slash, path = self.path.partition("?")[0].removeprefix("/").partition("/")
        if not hmac.compare_digest(token.encode("utf-8", "replace"), self.server.token):
            self._refuse(HTTPStatus.NOT_FOUND, "there is no such page")
            return None
        if not slash:
            self._begin(HTTPStatus.MOVED_PERMANENTLY, {"Location": f"/{token}/", "Content-Length": "0"})
            return None
        return path

    def _send(self, page: Page) -> None:
        kind = f"{page.kind}; charset=utf-8"
        self._begin(HTTPStatus.OK, {"Content-Type": kind, "Content-Length": str(len(page.data))})
        self.wfile.write(page.data)

    def _refuse(self, status: HTTPStatus, text: str) -> None:
        data = f"{text}\n".encode()
        headers = {"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(data))}
        self._begin(status, headers)
        with contextlib.suppress(OSError):
            self.wfile.write(data)

    def _begin(self, status: HTTPStatus, headers: Mapping[str, str] | None = None) -> None:
        self.send_response(status)
        for name, value in {**_HEADERS, **(headers or {})}.items():
            self.send_header(name, value)
        self.end_headers()

    def _stream(self) -> None:
        feed = self.server.feed
        with feed.reader() as is_free:
            if not is_free:
                self._refuse(HTTPStatus.SERVICE_UNAVAILABLE, "too many pages are open")
                return
            self._begin(HTTPStatus.OK, {"Content-Type": "text/event-stream; charset=utf-8"})
            self.wfile.write(b"retry: 2000\n\n")
            last, written = _last_number(self.headers.get("Last-Event-ID")), time.monotonic()
            while not self._is_gone():
                events = feed.after(last, _TICK)
                if events:
                    self.wfile.write(b"".join(map(_bytes, events)))
                    last, written = events[-1].number, time.monotonic()
                    time.sleep(_REST)
                elif feed.is_closed:
                    return
                elif time.monotonic() - written > _HEARTBEAT:
                    self.wfile.write(b": still here\n\n")
                    written = time.monotonic()

    def _is_gone(self) -> bool:
        """Return whether the browser has closed the connection, or sends more, which is not supported."""
        poll = select.poll()
        poll.register(self.connection, select.POLLIN)
        return bool(poll.poll(0))

    def log_message(self, format: str, *args: Any) -> None:
        """Log nothing, since the terminal belongs to the campaign and the address is secret."""


def _bytes(event: LiveEvent) -> bytes:
    data = json.dumps(event.data, ensure_ascii=False, allow_nan=False)
    return f"id: {event.number}\nevent: {event.kind}\ndata: {data}\n\n".encode("utf-8", "replace")


def _last_number(text: str | None) -> int:
    return int(text) if text is not None and re.fullmatch(r"[0-9]{1,15}", text) else 0
