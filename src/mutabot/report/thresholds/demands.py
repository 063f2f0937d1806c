"""Demands that a campaign meets, as TOML for the configuration."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from mutabot.analysis.thresholds.demands import suggested
from mutabot.analysis.thresholds.ladders import Ladder
from mutabot.analysis.thresholds.words import line_of
from mutabot.model.graded.demand import OFFSET


def suggested_toml(ladders: Sequence[Ladder], *, table: str) -> str:
    """A demand for each quantity and site, of which both directions are met.

    ``table`` is the name of the tables: ``tool.mutabot.demand``, or ``demand`` in a file of mutabot's own.
    Where none can be suggested, a comment says why.
    """
    found: dict[str, list[Ladder]] = {}
    for one in ladders:
        found.setdefault(f"{one.mutant.site.id} {one.pair_name} {one.unit}", []).append(one)
    blocks = ["\n".join(_block(both, table)) for both in found.values()]
    return "\n\n".join(blocks)


def _block(both: Sequence[Ladder], table: str) -> Iterator[str]:
    for one in both:
        yield f"# {one.place} {one.name}: {line_of(one)}"
    sizes = [suggested(one) for one in both]
    known = [size for size in sizes if size is not None]
    first = both[0]
    if len(known) < len(sizes):
        yield "# no demand: some round neither notices nor refuses it, or the ladder ends too soon"
        return
    yield f"[[{table}]]"
    yield f"site = {_text(first.mutant.site.id)}"
    if first.mutant.quantity is not None:
        yield f"quantity = {_text(first.mutant.quantity)}"
    if first.mutant.operator != OFFSET:
        yield f"operator = {_text(first.mutant.operator)}"
    notice = f"{max(known):.12g} {first.unit or ''}"
    yield f"notice = {_text(notice.strip())}"


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
