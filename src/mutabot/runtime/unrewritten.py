"""Importing modules of mutabot, and of the packages beside it, as they are."""

from __future__ import annotations

import sys
from typing import Any


def import_us_unrewritten() -> None:
    """From now on pytest does not rewrite modules of mutabot that are imported.

    It would rewrite the asserts of everything in a plugin's distribution, and parse each module anew in
    every process, as none may write bytecode beside the sources.
    """
    for finder in sys.meta_path:
        marked: Any = getattr(finder, "_must_rewrite", None)
        if isinstance(marked, set):
            marked.difference_update([name for name in marked if name.partition("_")[0] == "mutabot"])
            getattr(finder, "_marked_for_rewrite_cache", {}).clear()
