"""The files of a report while its campaign runs, made from the current journal."""

from __future__ import annotations

from contextlib import closing
from importlib.resources import files
from pathlib import Path
from typing import Any

from mutabot.errors import JournalError
from mutabot.report.texts import Cleaner, legible, portable
from mutabot.results.results import MutantResult, Results
from mutabot.results.stored import StoredEvidence
from mutabot.results.suggested import kept_suggestions

from .folder import Recorded, campaign_data, mutant_page, script, sources_data

#: bytes of recordings that a mutant's page may take
_ROOM = 4_000_000


class LiveReport:
    """The files of a report, as ``write_folder`` writes them, of a campaign that may still run.

    Args:
        journal: the path of its journal.
        name: what the project is called.
    """

    def __init__(self, journal: Path, name: str) -> None:
        self._journal, self._name = journal, name
        self._version = 0
        self._campaign: Results | None = None
        self._clean = Cleaner(None)
        self._recorded: Recorded | None = None
        self._whole: dict[str, bytes] = {}

    @staticmethod
    def assets() -> dict[str, bytes]:
        """Return the files that are the same for all campaigns by their names; ``index.html`` is the page."""
        return {path.name: path.read_bytes() for path in files(__package__).joinpath("assets").iterdir()}

    @staticmethod
    def legible(text: str) -> str:
        """Return a text in which characters that a page cannot show are replaced."""
        return legible(text)

    def read(self, version: int) -> None:
        """Read the journal again, so that later scripts contain its current data.

        ``version``: stands in the data of the campaign, by which a browser knows them.
        """
        self._version = version
        self._campaign = None
        self._whole.clear()
        try:
            stored = Results.read(self._journal)
        except JournalError:  # there is none yet
            return
        if stored.attempt is None and stored.everything:  # else it is still that of the campaign before
            self._campaign, self._clean = portable(stored), Cleaner(stored.meta.get("root"))

    def campaign(self) -> bytes:
        """Return the script with the list of mutants; empty until there is a plan."""
        if self._campaign is None:
            return b""
        if "campaign" not in self._whole:
            with closing(StoredEvidence(self._journal)) as evidence:
                of_page = {"recorded": evidence.has_original(), "version": self._version}
            data = {**campaign_data(self._campaign, self._name), **of_page}
            self._whole["campaign"] = script("campaign", data)
        return self._whole["campaign"]

    def sources(self) -> bytes:
        """Return the script with the texts of the mutated files; empty until there is a plan."""
        if self._campaign is None:
            return b""
        if "sources" not in self._whole:
            self._whole["sources"] = script("sources", sources_data(self._campaign))
        return self._whole["sources"]

    def mutant(self, number: int) -> bytes | None:
        """Return the script of the mutant with this number, with its recordings; None if there is none."""
        if self._campaign is None:
            return None
        result = next((mutant for mutant in self._campaign.mutants if mutant.mutant.number == number), None)
        if result is None:
            return None
        suggestion = kept_suggestions(self._journal, self._campaign.meta).get(result.mutant.id)
        page = script(f"mutant {number}", mutant_page(result, suggestion))
        with closing(StoredEvidence(self._journal)) as evidence:
            # originals that were asked for before keep their numbers: browsers know them by these
            known = self._recorded.originals if self._recorded is not None else {}
            recorded = self._recorded = Recorded(evidence, self._clean, known)
            data = _recordings(recorded, result)
            return page + (script(f"recordings {number}", data) if any(data.values()) else b"")

    def original(self, number: int) -> bytes | None:
        """Return the script of a recording of the original that a mutant's names; None if there is none."""
        originals = [*self._recorded.originals.values()] if self._recorded is not None else []
        return script(f"original {number}", originals[number]) if number < len(originals) else None


def _recordings(recorded: Recorded, result: MutantResult) -> dict[str, Any]:
    found: list[Any] = []
    used = 0
    for recording in recorded.of(result):
        used += len(script("", recording))
        if used > _ROOM:
            break
        found.append(recording)
    return {"recordings": found, "without": recorded.count(result) - len(found)}
