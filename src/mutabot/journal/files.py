"""What of mutabot lies in a project: journals, and folders with reports."""

from __future__ import annotations

from pathlib import Path

#: mutabot's folder in a project, and its journals: of `run`, of `compare`, and of that without an oracle
HOME = ".mutabot"
JOURNAL, COMPARISON, WITHOUT_ORACLE = "journal.sqlite", "compare.sqlite", "compare-no-oracle.sqlite"
#: by this file a folder is known to be a report of ours: it may be replaced, and no test depends on it
REPORT_MARK = "mutabot-report.txt"


def find_journal(project: Path, name: str = JOURNAL) -> Path:
    """A journal of the project, that of ``run`` if not said otherwise, also from a folder inside it.

    If there is none, where it would be.
    """
    folders = (project.resolve(), *project.resolve().parents)
    paths = [folder / HOME / name for folder in folders]
    return next((path for path in paths if path.is_file()), paths[0])


def previous_of(journal: Path) -> Path:
    """Where the last complete campaign before a journal's is kept: ``journal.previous.sqlite``."""
    return journal.with_name(f"{journal.stem}.previous{journal.suffix}")
