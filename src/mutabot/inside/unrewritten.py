"""Importing mutabot's own modules as they are."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def unrewritten() -> Iterator[None]:
    """Inside, pytest does not rewrite what is imported.

    It would rewrite the asserts of everything in a plugin's distribution, and parse each module anew in
    every process, as none may write bytecode beside the sources.
    """
    finders = [finder for finder in sys.meta_path if type(finder).__name__ == "AssertionRewritingHook"]
    for finder in finders:
        sys.meta_path.remove(finder)
    try:
        yield
    finally:
        sys.meta_path[:0] = finders
