"""What a browser may ask for: the report's own page and scripts, with data as the journal has them now.

Names are looked up in tables and never become paths: what is not in them is not there.
"""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from mutabot.errors import JournalError
from mutabot.report.html.folder import Recorded, campaign_data, mutant_page, script
from mutabot.report.texts import Cleaner, portable
from mutabot.results.results import MutantResult, Results
from mutabot.results.stored import StoredEvidence
from mutabot.results.suggested import kept_suggestions

#: seconds between two looks into the journal, at least; and how many times as long as one takes
_LEAST, _TIMES = 1.0, 20.0
#: bytes of recordings that a mutant's page may take
_ROOM = 4_000_000
_KINDS = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}
_NUMBERED = re.compile(r"data/(mutants|originals)/([0-9]{1,7})\.js")
#: the report from disk asks nobody for anything; this one asks the server that it came from
_POLICY = ("default-src 'none';", "default-src 'none'; connect-src 'self';")
_STYLE = '<link rel="stylesheet" href="assets/live.css">\n</head>'
_SCRIPT = '<script src="assets/live.js"></script>\n<script src="data/campaign.js">'


@dataclass(frozen=True, slots=True)
class Page:
    """Something to send: its type, and its bytes."""

    kind: str
    data: bytes


@dataclass(frozen=True, slots=True)
class _CampaignSnapshot:
    """The campaign as it was when the journal was last looked into.

    Attributes:
        version: up to which step all outcomes are in it.
        campaign: fit for reports; None if it has no plan yet.
        clean: makes texts of recordings so.
    """

    version: int
    campaign: Results | None
    clean: Callable[[str], str]


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
        self._journal, self._name, self._version = journal, name, version
        self._assets = dict(_assets())
        self._lock = threading.Lock()
        self._snapshot = _CampaignSnapshot(0, None, Cleaner(None))
        self._scripts: dict[str, bytes] = {}
        self._recorded: Recorded | None = None
        self._next = 0.0
        self.every = _LEAST

    def get(self, path: str) -> Page | None:
        """What is at a path; None if there is nothing."""
        if path in self._assets:
            return self._assets[path]
        numbered = _NUMBERED.fullmatch(path)
        if numbered is None and path not in ("data/campaign.js", "data/sources.js"):
            return None
        with self._lock:
            snapshot = self._look()
            if numbered is None:
                return _script(self._whole(path, snapshot))
            make = self._mutant if numbered[1] == "mutants" else self._original
            found = make(int(numbered[2]), snapshot)
        return None if found is None else _script(found)

    def look_at_once(self) -> None:
        """The campaign has ended: the next who asks gets all of it."""
        with self._lock:
            self._next = 0.0

    def _look(self) -> _CampaignSnapshot:
        """The campaign, as new as may be: reading must not take the time of those who do the work."""
        version, now = self._version(), time.monotonic()
        if version == self._snapshot.version or now < self._next:
            return self._snapshot
        self._snapshot = _CampaignSnapshot(version, *self._read())
        self._scripts.clear()
        took = time.monotonic() - now
        self.every = max(_LEAST, _TIMES * took)
        self._next = now + took + self.every
        return self._snapshot

    def _read(self) -> tuple[Results | None, Callable[[str], str]]:
        try:
            stored = Results.read(self._journal)
        except JournalError:  # there is none yet
            return None, Cleaner(None)
        if stored.attempt is not None or not stored.everything:
            return None, Cleaner(None)  # it is still that of the campaign before
        return portable(stored), Cleaner(stored.meta.get("root"))

    def _whole(self, path: str, snapshot: _CampaignSnapshot) -> bytes:
        campaign = snapshot.campaign
        if campaign is None:
            return b""
        if path not in self._scripts:
            if path == "data/campaign.js":
                data: Any = {**campaign_data(campaign, self._name), "version": snapshot.version}
                self._scripts[path] = script("campaign", data)
            else:
                sources = [[file, text] for file, text in campaign.sources.items()]
                self._scripts[path] = script("sources", sources)
        return self._scripts[path]

    def _mutant(self, number: int, snapshot: _CampaignSnapshot) -> bytes | None:
        campaign = snapshot.campaign
        found = (one for one in campaign.mutants if one.mutant.number == number) if campaign else iter(())
        result = next(found, None)
        if result is None:
            return None
        suggestions = kept_suggestions(self._journal, campaign.meta) if campaign is not None else {}
        page = script(f"mutant {number}", mutant_page(result, suggestions.get(result.mutant.id)))
        with closing(StoredEvidence(self._journal)) as evidence:
            # originals that were asked for before keep their numbers: browsers know them by these
            known = self._recorded.originals if self._recorded is not None else {}
            recorded = self._recorded = Recorded(evidence, snapshot.clean, known)
            data = _recordings(recorded, result)
            return page + (script(f"recordings {number}", data) if any(data.values()) else b"")

    def _original(self, number: int, snapshot: _CampaignSnapshot) -> bytes | None:
        originals = [*self._recorded.originals.values()] if self._recorded is not None else []
        return script(f"original {number}", originals[number]) if number < len(originals) else None


def _recordings(recorded: Recorded, result: MutantResult) -> dict[str, Any]:
    found: list[Any] = []
    used = 0
    for one in recorded.of(result):
        used += len(script("", one))
        if used > _ROOM:
            break
        found.append(one)
    return {"recordings": found, "without": recorded.count(result) - len(found)}


def _script(data: bytes) -> Page:
    return Page(_KINDS[".js"], data)


def _assets() -> Iterator[tuple[str, Page]]:
    for package in ("mutabot.report.html", "mutabot_live"):
        for one in files(package).joinpath("assets").iterdir():
            kind = _KINDS.get(Path(one.name).suffix)
            if kind is not None and one.name != "index.html":
                yield f"assets/{one.name}", Page(kind, one.read_bytes())
    yield "", Page(_KINDS[".html"], index().encode())


def index() -> str:
    """The report's page, with what keeps it up to date."""
    text = files("mutabot.report.html").joinpath("assets", "index.html").read_text(encoding="utf-8")
    for old, new in (_POLICY, ("</head>", _STYLE), ('<script src="data/campaign.js">', _SCRIPT)):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text
