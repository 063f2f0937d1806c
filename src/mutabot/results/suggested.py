"""Checks that are suggested, as plain data: what each looks at, how sure it is, and what it kills."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import field
from pathlib import Path
from typing import Any

from mutabot.errors import UsageError
from mutabot.frozen import frozen
from mutabot.model.codec import from_data, to_data


@frozen
class Suggestion:
    """One check, proven.

    Attributes:
        test: node id of the test that it is added to, without parameters.
        style: ``pytest``, ``unittest``, or ``other`` for a test that another tool makes.
        looks_at: the expression that it reads.
        statement: the assertion.
        tolerance: how far the reading may be off, in its unit; None where it must be equal.
        spread: how far runs of the original are apart; None where they must be equal.
        runs: runs of the original that were measured.
        fresh: fresh seeds in which it was run on the original afterwards; it passed in all.
        unseen: share of runs in which it may fail although it did not in these, with 95 % confidence.
        kills: id of each mutant that it kills by itself, to the 0-based rounds in which it does.
        by_hand: all that is to be added where no diff can: to a test that another tool makes; else empty.
    """

    test: str
    style: str
    looks_at: str
    statement: str
    tolerance: float | None
    spread: float | None
    runs: int
    fresh: int
    unseen: float
    kills: Mapping[str, tuple[int, ...]]
    by_hand: str = ""


@frozen
class Unsolved:
    """A survivor that no suggestion kills.

    Attributes:
        mutant: its id.
        reason: why not.
        never: whether no observation at the ends of these tests could kill it.
    """

    mutant: str
    reason: str
    never: bool = False


@frozen
class Dropped:
    """A check that failed its proof.

    Attributes:
        test: the test that it was added to.
        statement: the assertion.
        reason: how it failed.
    """

    test: str
    statement: str
    reason: str


@frozen
class Suggestions:
    """What ``mutabot suggest`` found.

    Attributes:
        suggestions: those first that kill most.
        diff: all of them as one unified diff of the project.
        unsolved: survivors that none of them kills.
        dropped: checks that failed their proof.
        numbers: number of each survivor by its id.
        descriptions: what each survivor does, by its id.
        rounds: rounds of the campaign.
        seeds: fresh seeds that were run for the bands, and as many others for the proof.
    """

    suggestions: tuple[Suggestion, ...] = ()
    diff: str = ""
    unsolved: tuple[Unsolved, ...] = ()
    dropped: tuple[Dropped, ...] = ()
    numbers: Mapping[str, int] = field(default_factory=dict)
    descriptions: Mapping[str, str] = field(default_factory=dict)
    rounds: int = 0
    seeds: int = 0


#: what tells campaigns of the same journal apart
_STARTED = "started"


def keep_suggestions(journal: Path, meta: Mapping[str, Any], found: Suggestions) -> None:
    """Write them down for reports of this campaign. Raises UsageError if that cannot be done."""
    path = _path(journal)
    data = {_STARTED: meta.get(_STARTED), "found": to_data(found)}
    try:
        path.write_text(json.dumps(data), encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{path} cannot be written: {error.strerror}") from error


def kept_suggestions(journal: Path, meta: Mapping[str, Any]) -> Suggestions | None:
    """Those for this campaign; None if none were looked for since, or the file is of another version."""
    try:
        data = json.loads(_path(journal).read_text(encoding="utf-8"))
        if data[_STARTED] != meta.get(_STARTED):
            return None
        return from_data(Suggestions, data["found"])
    except (OSError, ValueError, LookupError, TypeError):
        return None


def _path(journal: Path) -> Path:
    return journal.with_name(f"{journal.stem}-suggestions.json")
