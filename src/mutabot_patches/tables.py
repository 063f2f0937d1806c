"""The configuration table of patches."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from mutabot.api.processes import Table


class PatchesTable(Table):
    """For [patches as mutants](patches.md), which `--family patch` runs."""

    files: Annotated[tuple[str, ...], Field(strict=False, min_length=1)] = ("patches",)
    """Unified diffs: files, patterns, and folders with files `*.patch` and `*.diff`.

        files = ["bugs/*.patch"]
    """
