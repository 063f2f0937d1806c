"""What ``mutabot compare`` shows: a campaign over all families, and perhaps one without an oracle."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from mutabot.analysis.families import FamilyComparison, compare_families, is_same_campaign
from mutabot.analysis.results import Results, read_results
from mutabot.campaign import run as campaign
from mutabot.campaign.request import Progress, Request
from mutabot.errors import JournalError
from mutabot.journal.files import COMPARISON, WITHOUT_ORACLE
from mutabot.journal.reader import JournalReader


def run(request: Request, progress: Progress, *, no_oracle: bool) -> FamilyComparison:
    """Run what is to be compared, and compare it.

    Without an oracle the first exception decides: which tests notice a mutant, the other campaign tells.
    """
    first = replace(request, every_test=True, no_oracle=False, journal=COMPARISON)
    results = _read(campaign.run_campaign(first, progress))
    if not no_oracle:
        return compare_families(results)
    progress.note("once more, with every assertion switched off")
    second = replace(request, every_test=False, no_oracle=True, journal=WITHOUT_ORACLE)
    return compare_families(results, _read(campaign.run_campaign(second, progress)))


def read(home: Path) -> FamilyComparison:
    """The last comparison, from mutabot's folder in a project.

    The campaign without an oracle counts only if it belongs to it. Raises JournalError if there is none.
    """
    path, other = home / COMPARISON, home / WITHOUT_ORACLE
    if not path.is_file():
        raise JournalError(f"{path}: there is no comparison yet; `mutabot compare` makes one", path=str(path))
    results = _read(path)
    second = _read(other) if other.is_file() else None
    return compare_families(
        results, second if second is not None and is_same_campaign(results, second) else None
    )


def _read(path: Path) -> Results:
    with JournalReader.open(path) as journal:
        return read_results(journal)
