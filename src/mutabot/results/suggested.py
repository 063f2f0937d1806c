"""Suggestions for survivors, kept beside the journal for reports of its campaign."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mutabot.errors import UsageError
from mutabot.frozen import frozen
from mutabot.model.codec import from_data, to_data


@frozen
class Suggestion:
    """A suggestion for a survivor: a check that kills it, or why there is none.

    Attributes:
        test: node id of the test that the check is added to, without parameters; empty if there is no check.
        code: the statement to add to it; empty if there is no check.
        notes: what reports say of the check, a line each.
        reason: why there is none; empty if there is a check.
    """

    test: str = ""
    code: str = ""
    notes: tuple[str, ...] = ()
    reason: str = ""


#: facts that distinguish campaigns of the same journal
_STARTED = "started"


def keep_suggestions(journal: Path, meta: Mapping[str, Any], found: Mapping[str, Suggestion]) -> None:
    """Write suggestions, by the ids of survivors, for this campaign. Raises UsageError if that fails."""
    path = _path(journal)
    data = {_STARTED: meta.get(_STARTED), "found": to_data(found)}
    try:
        path.write_text(json.dumps(data), encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{path} cannot be written: {error.strerror}") from error


def kept_suggestions(journal: Path, meta: Mapping[str, Any]) -> Mapping[str, Suggestion]:
    """Return the suggestions for this campaign; empty if there are none of this version of mutabot."""
    try:
        data = json.loads(_path(journal).read_text(encoding="utf-8"))
        if data[_STARTED] != meta.get(_STARTED):
            return {}
        return from_data(dict[str, Suggestion], data["found"])
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return {}


def _path(journal: Path) -> Path:
    return journal.with_name(f"{journal.stem}-suggestions.json")
