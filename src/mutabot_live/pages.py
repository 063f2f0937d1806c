"""The pages that browsers may request: the report's page and scripts, with current data of the journal.

Names are looked up in tables and never become paths: what is not in them is not there.
"""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from mutabot.api.reports import LiveReport

#: seconds between two looks into the journal, at least; and how many times as long as one takes
_LEAST, _TIMES = 1.0, 20.0
_KINDS = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}
_NUMBERED = re.compile(r"data/(mutants|originals)/([0-9]{1,7})\.js")
#: the report from disk makes no requests; this one asks the server that it came from
_POLICY = ("default-src 'none';", "default-src 'none'; connect-src 'self';")
_STYLE = '<link rel="stylesheet" href="assets/live.css">\n</head>'
_SCRIPT = '<script src="assets/live.js"></script>\n<script src="data/campaign.js">'


@dataclass(frozen=True, slots=True)
class Page:
    """A response: its type, and its bytes."""

    kind: str
    data: bytes


class Pages:
    """The pages of a campaign.

    Args:
        journal: where its outcomes are.
        name: what the project is called.
        version: how many steps the campaign has done; 0 before the journal is its own.

    Attributes:
        every: seconds after which it is worth to ask again.
    """

    def __init__(self, journal: Path, name: str, version: Callable[[], int]) -> None:
        self._report, self._version = LiveReport(journal, name), version
        self._assets = dict(_assets())
        self._lock = threading.Lock()
        self._read = 0
        self._next = 0.0
        self.every = _LEAST

    def get(self, path: str) -> Page | None:
        """Return the page at a path; None if there is none."""
        if path in self._assets:
            return self._assets[path]
        whole = {"data/campaign.js": self._report.campaign, "data/sources.js": self._report.sources}
        numbered = _NUMBERED.fullmatch(path)
        if numbered is None and path not in whole:
            return None
        with self._lock:
            self._look()
            if numbered is None:
                return _script(whole[path]())
            of = self._report.mutant if numbered[1] == "mutants" else self._report.original
            found = of(int(numbered[2]))
        return None if found is None else _script(found)

    def look_at_once(self) -> None:
        """Let the next request get all data, since the campaign has ended."""
        with self._lock:
            self._next = 0.0

    def _look(self) -> None:
        """Read the journal at limited intervals, so that reading takes little time from the campaign."""
        version, now = self._version(), time.monotonic()
        if version == self._read or now < self._next:
            return
        self._report.read(version)
        self._read = version
        took = time.monotonic() - now
        self.every = max(_LEAST, _TIMES * took)
        self._next = now + took + self.every


def _script(data: bytes) -> Page:
    return Page(_KINDS[".js"], data)


def _assets() -> Iterator[tuple[str, Page]]:
    found = LiveReport.assets()
    own = files("mutabot_live").joinpath("assets").iterdir()
    for name, data in (*found.items(), *((entry.name, entry.read_bytes()) for entry in own)):
        kind = _KINDS.get(Path(name).suffix)
        if kind is not None and name != "index.html":
            yield f"assets/{name}", Page(kind, data)
    yield "", Page(_KINDS[".html"], index(found["index.html"].decode()).encode())


def index(text: str) -> str:
    """Return the report's page, with the script that updates it."""
    for old, new in (_POLICY, ("</head>", _STYLE), ('<script src="data/campaign.js">', _SCRIPT)):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text
