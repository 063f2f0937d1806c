"""The checks that were suggested last, beside the journal of the campaign that they are for."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mutabot.analysis.suggested import Suggestions
from mutabot.border.codec import from_data, to_data
from mutabot.errors import UsageError

#: what tells campaigns of the same journal apart
_CAMPAIGN = "started"


def keep_suggestions(journal: Path, meta: Mapping[str, Any], found: Suggestions) -> None:
    """Write them down for reports of this campaign. Raises UsageError if that cannot be done."""
    path = _path(journal)
    data = {_CAMPAIGN: meta.get(_CAMPAIGN), "found": to_data(found)}
    try:
        path.write_text(json.dumps(data), encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{path} cannot be written: {error.strerror}") from error


def kept_suggestions(journal: Path, meta: Mapping[str, Any]) -> Suggestions | None:
    """Those for this campaign; None if none were looked for since, or the file is of another version."""
    try:
        data = json.loads(_path(journal).read_text(encoding="utf-8"))
        if data[_CAMPAIGN] != meta.get(_CAMPAIGN):
            return None
        return from_data(Suggestions, data["found"])
    except (OSError, ValueError, LookupError, TypeError):
        return None


def _path(journal: Path) -> Path:
    return journal.with_name(f"{journal.stem}-suggestions.json")
