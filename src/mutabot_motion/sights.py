"""The ways to look at what is recorded, as they are asked for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from .choice import missing_in
from .shown import Shown
from .sight import Sight


def sights_of(home: Path, *, view: bool, rerun: bool, rrd: Path | None, mcap: Path | None) -> list[Sight]:
    """Those that are asked for. Raises UsageError for one that cannot be done here.

    ``home``: the project's folder of mutabot.
    """
    found: list[Sight] = []
    if rerun or rrd is not None:
        from .rrd import Rrd  # noqa: PLC0415  # each needs an extra of its own

        found.append(Rrd(home, rrd, opens=rerun))
    if mcap is not None:
        from .mcap import Mcap  # noqa: PLC0415  # likewise

        found.append(Mcap(mcap))
    if view:
        from .view import Viewer  # noqa: PLC0415  # likewise

        found.append(Viewer())
    return found


def show_all(sights: Iterable[Sight], shown: Shown) -> Iterator[str]:
    """Show it in these ways; says what is missing, and what there is then. Raises UsageError."""
    yield from missing_in(shown)
    for sight in sights:
        yield sight.show(shown)
