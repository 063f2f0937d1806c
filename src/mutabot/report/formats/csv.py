"""CSV: one row per outcome, in UTF-8 with a header. docs/reports.md has the columns."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

from mutabot.results.stored import COLUMNS, rows

if TYPE_CHECKING:
    from mutabot.report.format import Material


def make(material: Material) -> str:
    """The report. A value that is not known is an empty cell."""
    file = io.StringIO(newline="")
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(row.values() for row in rows(material.campaign))
    return file.getvalue()
