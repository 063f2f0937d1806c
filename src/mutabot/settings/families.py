"""Which families can be asked for: mutabot's own, and those that operators of plug-ins bring."""

from __future__ import annotations

from collections.abc import Iterable

from mutabot.errors import UsageError, unknown_name_text
from mutabot.families import FAMILIES, OF_CALLS, OF_TEXT


def why_unknown(name: str) -> str | None:
    """Why there is no family of this name, with the nearest that is there; None if there is one."""
    if name in FAMILIES or name in known_families():
        return None
    return unknown_name_text("family", name, known_families())


def asked_for(names: Iterable[str]) -> tuple[str, ...]:
    """These families, each once, in the order of their mutants' numbers.

    Raises UsageError for a name that is none.
    """
    names = list(names)
    for name in names:
        why = why_unknown(name)
        if why is not None:
            raise UsageError(why)
    known = FAMILIES if set(names) <= set(FAMILIES) else known_families()
    return tuple(family for family in known if family in names)


def need_vocabulary(families: Iterable[str]) -> bool:
    """Whether these families have mutants of calls: those of the program text need no vocabulary."""
    return any(family not in OF_TEXT for family in families)


def known_families() -> tuple[str, ...]:
    """All that can be asked for. Loads the plug-ins: raises OperatorError for one that is of no use."""
    from mutabot.operators import load_all  # noqa: PLC0415  # most campaigns ask for mutabot's own

    brought = dict.fromkeys(rule.family for rule in load_all() if rule.family not in FAMILIES)
    return (*OF_CALLS, *brought, *OF_TEXT)
