"""Which of the planned mutants to run.

Typing mistakes in ``--only`` and ``--skip`` that are seen without a plan are told before the baseline.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from functools import cached_property
from itertools import chain
from pathlib import Path

from mutabot.campaign.faults.providers import operators_of_packages
from mutabot.campaign.request import Request
from mutabot.errors import SelectionError, nearest_name
from mutabot.languages.front_end import program_files
from mutabot.model import LeftOut, Mutant
from mutabot.model.mutant import Role, fits, is_like, line_of, means_numbers
from mutabot.operators import registry
from mutabot.settings.families import known_families

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


_WILD = re.compile(r"[*?]")


def refuse_typos(request: Request) -> None:
    """Raises SelectionError for words that cannot fit a mutant of this project, whatever its plan is."""
    known = _Known(request)
    mistakes = [
        nothing_fits(option, unknown, known.words)
        for option, words in (("--only", request.only), ("--skip", request.skip))
        if (unknown := [word for word in words if not known.may_fit(word)])
    ]
    if mistakes:
        raise SelectionError(
            "\n".join(map(str, mistakes)),
            unknown=chain.from_iterable(mistake.unknown for mistake in mistakes),
        )


class _Known:
    """What mutants of a project can be named by, as far as it is known before the plan."""

    def __init__(self, request: Request) -> None:
        self._root = request.root
        configuration = request.configuration
        self._sources = (*configuration.program, *configuration.oracle)

    def may_fit(self, word: str) -> bool:
        """Whether there may be such a mutant. What holds wild signs or numbers is for the plan to say."""
        if means_numbers(word) or word.startswith("@"):  # what a list says is for the plan to say as well
            return True
        file, colon, _ = word.partition(":")
        if _WILD.search(file) or (not colon and (word in self._names or word in self._of_packages)):
            return True
        found = [known for known in self._files if _is_file(file, known)]
        line = line_of(word)
        if found and line is not None and _WILD.search(line[0]) is None:
            return any(line[1].start <= self._lines(known) for known in found)
        return bool(found) or _exists(self._root, file)

    @property
    def words(self) -> list[str]:
        """What may have been meant."""
        return [*self._names, *self._of_packages, *self._files]

    @cached_property
    def _names(self) -> tuple[str, ...]:
        return (*registry.names(), *known_families(), *(role.value for role in Role))

    @cached_property
    def _of_packages(self) -> tuple[str, ...]:
        """Operators that are none on calls; to look at them may take its time."""
        return tuple(operators_of_packages())

    @cached_property
    def _files(self) -> list[str]:
        return program_files(self._root, self._sources)

    def _lines(self, file: str) -> int:
        try:
            return (self._root / file).read_bytes().count(b"\n") + 1
        except OSError:
            return 0


def _is_file(word: str, file: str) -> bool:
    """Whether a word is a file, its last part, or a folder above it."""
    return (
        word == file
        or file.endswith("/" + word.removeprefix("…/"))
        or file.startswith(word.rstrip("/") + "/")
    )


def _exists(root: Path, file: str) -> bool:
    try:
        return bool(file) and (root / file).exists()
    except (OSError, ValueError):  # too long for a name, or with a zero in it
        return False
