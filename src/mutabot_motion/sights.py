"""The ways to look at what is recorded, as they are asked for. Each needs an extra of its own."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

from mutabot.errors import UsageError

from .shown import Shown

#: by the module that imports it: the library, the option that needs it, and the extra that brings it
_NEEDS = {
    "rrd": ("rerun-sdk", "--rrd needs (and --rerun)", "rerun"),
    "mcap": ("foxglove-sdk", "--mcap needs", "mcap"),
    "view": ("MuJoCo", "--view needs", "cells"),
    "pictures.video": ("PyAV and Pillow", "--video needs", "video"),
}


class Sight(Protocol):
    """One way to look at it. It is made before anything is read: UsageError says that it cannot be done."""

    def show(self, shown: Shown) -> str:
        """Do it. Returns what there is now, in words. Raises UsageError where it fails."""


def sights_of(home: Path, *, view: bool, rerun: bool, rrd: Path | None, mcap: Path | None) -> Iterator[Sight]:
    """Those that are asked for. Raises UsageError for one that cannot be done here.

    ``home``: the project's folder of mutabot.
    """
    if rerun or rrd is not None:
        yield module("rrd").Rrd(home, rrd, opens=rerun)
    if mcap is not None:
        yield module("mcap").Mcap(mcap)
    if view:
        yield module("view").Viewer()


def module(name: str) -> Any:
    """A module of this package. Raises UsageError if the library that it needs is not installed."""
    library, needs, extra = _NEEDS[name]
    try:
        return import_module(f"{__package__}.{name}")
    except ImportError as error:
        install = f"pip install 'path/to/mutabot[{extra}]'"
        raise UsageError(f"{needs} {library}, not installed here: {install}") from error
