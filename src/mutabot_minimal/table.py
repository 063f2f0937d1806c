"""The minimal set as text: rows for the terminal, and Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from mutabot.api.reports import Material, UsageError

from .minimal import KeptMutant, Minimal, minimal_of

#: what each column of the table of families says
COLUMNS = ("family", "mutants", "killed", "minimal set", "in the joint set", "there alone")
_NONE = "no minimal set: not every test was run on every mutant; `mutabot minimal` does"


def markdown(material: Material) -> str:
    """Return the minimal set in Markdown. Raises UsageError if not every test was run on every mutant."""
    found = minimal_of(material.campaign)
    if found is None:
        raise UsageError(_NONE)
    return "\n".join([f"### {title(found)}", "", *_table(COLUMNS, rows(found)), "", *_list(found), ""])


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


def _table(columns: Sequence[str], cells: Iterable[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(map(_escaped, row))} |" for row in (columns, ["---"] * len(columns), *cells)]


def _list(found: Minimal) -> Iterator[str]:
    yield from remarks(found)
    yield ""
    columns = ("no.", "place", "operator", "fault", "tests that kill it", "stands for")
    yield from _table(
        columns,
        (
            (str(kept.number), kept.place, kept.operator, kept.description, *_counts(kept))
            for kept in (*found.dominators, *found.survivors)
        ),
    )


def _counts(kept: KeptMutant) -> tuple[str, str]:
    return str(kept.killed_by), str(kept.stands_for)


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace("|", "\\|").replace("\n", " ")
