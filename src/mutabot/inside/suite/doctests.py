"""Mismatches of doctests: what they say, and where they stand."""

from __future__ import annotations

import sys
from typing import Any


def mismatch(error: BaseException) -> str | None:
    """What a doctest expected and what it got, in one line; None for any other exception."""
    if not _is_mismatch(error):
        return None
    failure: Any = error
    source, want = failure.example.source.strip(), failure.example.want.strip()
    return f"{source}: expected {want or 'nothing'}, got {failure.got.strip() or 'nothing'}"


def place_of_mismatch(error: BaseException) -> list[tuple[str, int]]:
    """File and line of the example; empty for any other exception, and where doctest knows neither."""
    failure: Any = error
    if not _is_mismatch(error) or failure.test.filename is None or failure.test.lineno is None:
        return []
    return [(failure.test.filename, failure.test.lineno + failure.example.lineno + 1)]


def _is_mismatch(error: BaseException) -> bool:
    doctest = sys.modules.get("doctest")  # who raised it has imported it
    return doctest is not None and isinstance(error, doctest.DocTestFailure)
