"""Which families can be asked for: those of the core, and those that packages bring."""

from __future__ import annotations

from collections.abc import Iterable

from mutabot.errors import UsageError, unknown_name_text
from mutabot.families import OF_CALLS
from mutabot.faults import families_brought


def why_unknown(name: str) -> str | None:
    """Why there is no family of this name, with the nearest that is there; None if there is one."""
    if name in OF_CALLS or name in families_brought() or name in known_families():
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
    known = OF_CALLS if set(names) <= set(OF_CALLS) else known_families()
    return tuple(family for family in known if family in names)


def known_families() -> tuple[str, ...]:
    """All that can be asked for. Raises OperatorError or ExtensionError for a package that is of no use."""
    from mutabot.operators import load_all  # noqa: PLC0415  # most campaigns ask for mutabot's own

    of_operators = (rule.family for rule in load_all())
    return tuple(dict.fromkeys((*OF_CALLS, *of_operators, *families_brought())))
