"""Which of the planned mutants to run."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from pathlib import Path

from mutabot.errors import SelectionError, nearest_name
from mutabot.model import LeftOut, Mutant
from mutabot.model.selector import fits, is_like

#: signs of a word that messages show
_LONGEST = 200


def select(
    mutants: Sequence[Mutant],
    only: Iterable[str] = (),
    skip: Iterable[str] = (),
    selection_file: Path | None = None,
    *,
    left_out: Iterable[LeftOut] = (),
) -> list[Mutant]:
    """The mutants that a selection file, ``only`` and ``skip`` leave, in the order of their numbers.

    A selection file holds one id (or an id with ``*`` and ``?``) per line; what follows ``#`` at the
    beginning of a line or after a space is a comment. Numbers are those of the plan, whatever is selected:
    all commands call a mutant by the same. ``only`` and ``skip`` take ids (also with ``*`` and
    ``?``), numbers (``3``, ``16-20``, ``3,16-20``), names of operators, families or roles, files, file globs,
    and lines (``mission.py:22``, ``mission.py:20-30``), and ``@FILE``, a file like a selection file.

    Raises SelectionError for anything that fits no mutant, nor one that the plan leaves out.
    """
    only, skip, left_out = list(only), list(skip), list(left_out)
    set_aside = [item.id for item in left_out]
    chosen = list(mutants) if selection_file is None else _from_file(selection_file, mutants, set_aside)
    wanted = _fitting(only, chosen, set_aside, "--only") if only else {mutant.id for mutant in chosen}
    wanted -= _fitting(skip, chosen, set_aside, "--skip")
    return [mutant for mutant in chosen if mutant.id in wanted]


def _from_file(file: Path, mutants: Sequence[Mutant], set_aside: Sequence[str]) -> list[Mutant]:
    """The mutants that a selection file names. Raises SelectionError."""
    found: set[str] = set()
    unknown: list[str] = []
    ids = {mutant.id for mutant in mutants}
    for pattern in _patterns(file, ids | {*set_aside}):
        if pattern in ids:  # as nearly all are, be there thousands; an id may hold signs that are wild
            found.add(pattern)
            continue
        here = {one for one in ids if is_like(pattern, one)}
        if not here and not any(is_like(pattern, other) for other in set_aside):
            unknown.append(pattern)
        found |= here
    if unknown:
        raise nothing_fits(str(file), unknown, [*(mutant.id for mutant in mutants), *set_aside])
    return [mutant for mutant in mutants if mutant.id in found]


def _of_id(pattern: str, mutants: Sequence[Mutant]) -> list[Mutant]:
    """The mutant with exactly this id, which may hold signs that are wild elsewhere."""
    return [mutant for mutant in mutants if mutant.id == pattern]


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


def _fitting(
    patterns: Iterable[str], mutants: Sequence[Mutant], set_aside: Sequence[str], option: str
) -> set[str]:
    found: set[str] = set()
    unknown = []
    for pattern in patterns:
        if pattern.startswith("@"):
            found |= {mutant.id for mutant in _from_file(Path(pattern[1:]), mutants, set_aside)}
            continue
        here = {mutant.id for mutant in _of_id(pattern, mutants) or mutants if fits(pattern, mutant)}
        if not here and not any(is_like(pattern, other) for other in set_aside):
            unknown.append(pattern)
        found |= here
    if unknown:
        raise nothing_fits(option, unknown, _names(mutants))
    return found


def _names(mutants: Sequence[Mutant]) -> list[str]:
    names: dict[str, None] = {}
    for mutant in mutants:
        span = mutant.site.span
        words = (mutant.operator, mutant.family, mutant.site.role.value, span.file, mutant.id)
        names.update(dict.fromkeys(words))
    return list(names)


def nothing_fits(source: str, unknown: Sequence[str], known: Sequence[str]) -> SelectionError:
    """The error for words that fit no mutant, with the nearest that is known to do."""
    lines = []
    for pattern in unknown:
        nearest = nearest_name(pattern, known) or nearest_name(pattern.partition(":")[0], known)
        hint = f"the nearest is {nearest!r}" if nearest else "`mutabot list` shows what there is"
        lines.append(f"{source}: no mutant fits {_shown(pattern)}; {hint}")
    return SelectionError("\n".join(lines), unknown=unknown)


def _shown(pattern: str) -> str:
    return repr(pattern if len(pattern) <= _LONGEST else f"{pattern[:_LONGEST]}…")
