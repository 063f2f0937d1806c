"""Requests to a server as browsers make them, over real sockets."""

from __future__ import annotations

import http.client
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any
from urllib.parse import urlsplit

#: seconds: only so that a test that fails does not hang
PATIENCE = 60.0


class Answer:
    """What came back."""

    def __init__(self, response: http.client.HTTPResponse) -> None:
        self.status, self.headers, self.text = response.status, response.headers, response.read().decode()


def ask(
    address: str, path: str = "", method: str = "GET", headers: Mapping[str, str] | None = None
) -> Answer:
    """One request. A path with a slash in front replaces that of the address, token included."""
    parts = urlsplit(address)
    connection = http.client.HTTPConnection(parts.netloc, timeout=PATIENCE)
    try:
        connection.putrequest(method, path if path.startswith("/") else parts.path + path, skip_host=True)
        for name, value in {"Host": parts.netloc, **(headers or {})}.items():
            if value:
                connection.putheader(name, value)
        connection.endheaders()
        return Answer(connection.getresponse())
    finally:
        connection.close()


def origin(address: str) -> dict[str, str]:
    """What a browser says of the page that sends a command."""
    return {"Origin": f"http://{urlsplit(address).netloc}"}


def command(address: str, name: str) -> int:
    """Give a command as the page does; returns the status."""
    return ask(address, name, "POST", origin(address)).status


@contextmanager
def listening(address: str, last: int | None = None) -> Iterator[Iterator[tuple[int, str, Any]]]:
    """The stream of events: number, kind, data."""
    parts = urlsplit(address)
    connection = http.client.HTTPConnection(parts.netloc, timeout=PATIENCE)
    headers = {} if last is None else {"Last-Event-ID": str(last)}
    connection.request("GET", f"{parts.path}events", headers=headers)
    response = connection.getresponse()
    assert response.headers["Content-Type"].startswith("text/event-stream")
    try:
        yield _events(response)
    finally:
        response.close()
        connection.close()


def _events(response: http.client.HTTPResponse) -> Iterator[tuple[int, str, Any]]:
    found: dict[str, str] = {}
    silent = 0
    for line in response:
        silent = silent + 1 if line.startswith(b":") else 0 if line.strip() else silent
        assert silent < 3, "nothing came"
        name, _, value = line.decode().rstrip("\n").partition(": ")
        if name:
            found[name] = value
        elif "data" in found:
            yield int(found["id"]), found["event"], json.loads(found["data"])
            found = {}
