"""What of mutabot lies in a project: journals, and folders with reports."""

from __future__ import annotations

from pathlib import Path

#: mutabot's folder in a project, and its journal
HOME = ".mutabot"
JOURNAL = "journal.sqlite"
#: by this file a folder is known to be a report of ours: it may be replaced, and no test depends on it
REPORT_MARK = "mutabot-report.txt"


def find_journal(project: Path) -> Path:
    """The journal of the project, also from a folder inside it.

    If there is none, where it would be.
    """
    folders = (project.resolve(), *project.resolve().parents)
    paths = [folder / HOME / JOURNAL for folder in folders]
    return next((path for path in paths if path.is_file()), paths[0])


def previous_of(journal: Path) -> Path:
    """Where the last complete campaign before a journal's is kept: ``journal.previous.sqlite``."""
    return journal.with_name(f"{journal.stem}.previous{journal.suffix}")
