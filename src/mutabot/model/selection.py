"""Select mutants by the words of ``--only`` and ``--skip``."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.errors import SelectionError, nearest_name
from mutabot.model.mutant_pattern import fits, is_like

if TYPE_CHECKING:
    from mutabot.model.left_out import LeftOut
    from mutabot.model.mutant import Mutant

#: share of letters from which on a name is near: what is typed here may as well be no misspelt name
_ALIKE = 0.6


def select(
    mutants: Sequence[Mutant],
    only: Iterable[str] = (),
    skip: Iterable[str] = (),
    *,
    left_out: Iterable[LeftOut] = (),
) -> list[Mutant]:
    """Return the mutants that match ``only`` and not ``skip``, in the order of their numbers.

    Numbers are those of the plan, whatever is selected:
    all commands call a mutant by the same. ``only`` and ``skip`` take ids (also with ``*`` and
    ``?``), numbers (``3``, ``16-20``, ``3,16-20``), names of operators, families or roles, files, file globs,
    and lines (``mission.py:22``, ``mission.py:20-30``), and ``@FILE``, a file with one id (or an id with
    ``*`` and ``?``) per line; what follows ``#`` at the beginning of a line or after a space is a comment.

    Raises SelectionError for anything that fits no mutant, nor one that the plan leaves out.
    """
    set_aside = [item.id for item in left_out]
    only = list(only)
    wanted = _fitting(only, mutants, set_aside, "--only") if only else {mutant.id for mutant in mutants}
    wanted -= _fitting(skip, mutants, set_aside, "--skip")
    return [mutant for mutant in mutants if mutant.id in wanted]


def _from_file(file: Path, mutants: Sequence[Mutant], set_aside: Sequence[str]) -> set[str]:
    """Return the mutants that a selection file names. Raises SelectionError."""
    patterns = _patterns(file, {*(mutant.id for mutant in mutants), *set_aside})
    return _fitting(patterns, mutants, set_aside, str(file), lambda word, mutant: is_like(word, mutant.id))


def _fitting(
    patterns: Iterable[str],
    mutants: Sequence[Mutant],
    set_aside: Sequence[str],
    source: str,
    fits_one: Callable[[str, Mutant], bool] = fits,
) -> set[str]:
    """Return the ids of the mutants that match words. Raises SelectionError for words without a match."""
    ids = {mutant.id for mutant in mutants}
    found: set[str] = set()
    unknown = []
    for pattern in patterns:
        if pattern in ids:  # as nearly all of a file are, be there thousands; an id may hold wild signs
            found.add(pattern)
        elif pattern.startswith("@") and fits_one is fits:
            found |= _from_file(Path(pattern[1:]), mutants, set_aside)
        else:
            here = {mutant.id for mutant in mutants if fits_one(pattern, mutant)}
            if not here and not any(is_like(pattern, other) for other in set_aside):
                unknown.append(pattern)
            found |= here
    if unknown:
        raise nothing_fits(source, unknown, [*_names(mutants), *set_aside])
    return found


def _patterns(file: Path, ids: Collection[str]) -> Iterator[str]:
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise SelectionError(f"cannot read the selection file {file}: {reason}") from error
    for line in text.splitlines():
        # An id of program text may hold anything; any other holds "#" too, but never after a space.
        pattern = line.strip()
        if pattern not in ids:
            pattern = re.split(r"(?:^|\s)#", line, maxsplit=1)[0].strip()
        if pattern:
            yield pattern


def _names(mutants: Sequence[Mutant]) -> list[str]:
    names = (
        (
            mutant.operator,
            mutant.family,
            mutant.site.role.value,
            *(span.file for span in mutant.site.spans),
            mutant.id,
        )
        for mutant in mutants
    )
    return list(dict.fromkeys(chain.from_iterable(names)))


def nothing_fits(source: str, unknown: Sequence[str], known: Sequence[str]) -> SelectionError:
    """Return the error for words that match no mutant, with the nearest known word."""
    lines = []
    for pattern in unknown:
        parts = (pattern, pattern.partition(":")[0])
        nearest = next((near for part in parts if (near := nearest_name(part, known, _ALIKE))), None)
        if nearest:
            hint = f"the nearest is {nearest!r}"
        elif "," in pattern and source.startswith("--"):
            hint = f"only numbers are separated by commas, so give {source} once for each name"
        elif "[" in pattern or "{" in pattern:
            hint = "only * and ? are wildcards"
        else:
            hint = "`mutabot list` shows what there is"
        shown = repr(pattern if len(pattern) <= 200 else f"{pattern[:200]}…")
        lines.append(f"{source}: no mutant matches {shown}; {hint}")
    return SelectionError("\n".join(lines))
