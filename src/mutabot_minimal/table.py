"""The minimal set as text: a row for each family, and a line for each mutant."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from .minimal import KeptMutant, Minimal

#: what each column of the table of families says
COLUMNS = ("family", "mutants", "killed", "minimal set", "in the joint set", "there alone")


def title(found: Minimal) -> str:
    """Return how many mutants are left of how many."""
    return (
        f"Minimal set: {found.size} of {found.mutants} mutants, {len(found.dominators)} killed and "
        f"{len(found.survivors)} survivors"
    )


def rows(found: Minimal) -> list[tuple[str, ...]]:
    """Return a row for each family, and one for all together."""
    each = [
        (one.family, *map(str, (one.mutants, one.killed, one.minimal, one.joint, one.alone)))
        for one in found.families
    ]
    joint = str(len(found.dominators))
    return [*each, ("together", str(found.mutants), str(found.killed), joint, joint, "")]


def remarks(found: Minimal) -> Iterator[str]:
    """Yield what there is to know about the table."""
    yield "A suite that kills the killed ones of the set kills all that this suite kills (docs/compare.md)."
    if found.unknown:
        yield f"{found.unknown} killed mutants are in no class: not every test was run on them."
    if found.seconds is not None:
        yield f"Every test on every mutant took {found.seconds:.0f} s."


def aligned(columns: Sequence[str], cells: Iterable[Sequence[str]]) -> list[str]:
    """Return a table as lines: the first column to the left, numbers to the right."""
    lines = [tuple(columns), *map(tuple, cells)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return [
        "  ".join([line[0].ljust(widths[0]), *map(str.rjust, line[1:], widths[1:])]).rstrip()
        for line in lines
    ]


def described(kept: KeptMutant) -> str:
    """Return a mutant of the set in a line."""
    more = f"; stands for {kept.stands_for} others" if kept.stands_for else ""
    return f"{kept.number} {kept.place} {kept.operator}: {kept.description}{more}"
