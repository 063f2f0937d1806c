"""Lines on remarks about the vocabulary: one for all operations of which the same is to be said."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from mutabot.errors import in_short

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mutabot.model.events import Remark

#: what differs between remarks of one kind
_COUNTS = re.compile(r"\d+ tests?")
#: operations that a line names beside its first
_NAMES = 6


def lines_of(remarks: Iterable[Remark]) -> list[str]:
    """Return the remarks as lines; those that differ only in the operation and numbers of tests share one."""
    alike: dict[tuple[str, str, str], list[Remark]] = {}
    for remark in remarks:
        file, _, _ = remark.source.partition(":")
        alike.setdefault((file, remark.key, _COUNTS.sub("", remark.text)), []).append(remark)
    return [_line(those) for those in alike.values()]


def _line(remarks: list[Remark]) -> str:
    first, *others = remarks
    names = [remark.source.rpartition(" · ")[2] for remark in others]
    return f"{first}; likewise {in_short(names, _NAMES)}" if names else str(first)
