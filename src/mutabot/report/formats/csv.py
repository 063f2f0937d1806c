"""CSV: one row per outcome, in UTF-8 with a header. docs/reports.md has the columns.

A spreadsheet takes a text for a formula that begins like one: it gets an apostrophe before it.
"""

from __future__ import annotations

import csv
import io
import re
from typing import TYPE_CHECKING, Any

from mutabot.results.stored import COLUMNS, rows

if TYPE_CHECKING:
    from mutabot.report.format import Material


#: how a formula begins, also in the wide signs of East Asian keyboards
_FORMULA = tuple("=+-@\t\r\n\uff1d\uff0b\uff0d\uff20")
_QUOTED = frozenset(',"\n')
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.IGNORECASE | re.ASCII)


def make(material: Material) -> str:
    """Return the report. A missing value is an empty cell."""
    file = io.StringIO(newline="")
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(map(_cell, row.values()) for row in rows(material.campaign))
    return file.getvalue()


def _cell(value: Any) -> Any:
    if isinstance(value, str) and _QUOTED.isdisjoint(value):  # Python writes such a cell as it is
        value = value.replace("\r", "\n")
    is_text = isinstance(value, str) and value.startswith(_FORMULA) and not _NUMBER.fullmatch(value)
    return f"'{value}" if is_text else value
