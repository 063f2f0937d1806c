"""``mutabot-accepted.toml``: survivors that are accepted, and mutants that are not run, each with a reason.

It lies beside the configuration and is meant to be committed. ``mutabot accept`` adds to its end; what a user
writes in it stays as it is.
"""

from __future__ import annotations

import datetime
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from mutabot.errors import ConfigurationError
from mutabot.model.suppression import Action, Suppression

from .document import Document
from .mistakes import DocumentPlace, raise_errors
from .table import Table

#: the name of the file in a project's folder
FILE = "mutabot-accepted.toml"
_HEAD = """\
# Survivors that are accepted ([[accept]]) and mutants that are not run ([[exclude]]), each with a reason.
# `mutabot accept` adds to this file; commit it.
"""
#: how texts of TOML write what cannot stand in them
_ESCAPES = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\t": "\\t", "\r": "\\r"}


def _reason(text: str) -> str:
    if not text.strip():
        raise ValueError("is empty; say why")
    return text.strip()


_Name = Annotated[str, Field(min_length=1)]


class Entry(Table):
    """One ``[[accept]]`` or ``[[exclude]]``."""

    why: Annotated[str, AfterValidator(_reason)]
    id: _Name | None = None
    file: _Name | None = None
    operator: _Name | None = None
    line: _Name | None = None
    date: datetime.date | None = None


class _Entries(Table):
    """The whole file."""

    accept: Annotated[tuple[dict[str, Any], ...], Field(strict=False)] = ()
    exclude: Annotated[tuple[dict[str, Any], ...], Field(strict=False)] = ()


def read_suppressions(root: Path) -> tuple[Suppression, ...]:
    """Return the decisions in the file of a project; none without a file.

    Raises ConfigurationError, about all mistakes at once.
    """
    if not (root / FILE).exists():
        return ()
    place = DocumentPlace(Document.read(root / FILE, FILE, ConfigurationError))
    entries = place.table(_Entries, place.document.data)
    found: list[Suppression] = []
    for action in Action if entries is not None else ():
        for index, raw in enumerate(getattr(entries, action.value)):
            found.extend(_suppression(place / action.value / index, action, raw))
    raise_errors(place.errors)
    return tuple(found)


def _suppression(place: DocumentPlace, action: Action, raw: Mapping[str, Any]) -> Iterator[Suppression]:
    """Yield the decision of an entry, or note its mistake."""
    entry = place.table(Entry, raw)
    if entry is None:
        return
    if not (entry.id or entry.line or entry.file or entry.operator):
        place.error("names no mutant: write `id`, or some of `file`, `operator` and `line`")
    line = place.document.line(place.path)
    yield Suppression(
        action,
        entry.why,
        f"{FILE}:{line}",
        id=entry.id or "",
        file=entry.file or "",
        operator=entry.operator or "",
        line=(entry.line or "").strip(),
        date=entry.date.isoformat() if entry.date is not None else "",
    )


def add_acceptances(root: Path, entries: Iterable[tuple[str, str]], why: str, date: datetime.date) -> None:
    """Add ``(id, line of the program)`` to the file, which is made if there is none.

    Raises ConfigurationError if it cannot be written.
    """
    path = root / FILE
    tables = [_written({"id": id, "line": line, "why": why}, date) for id, line in entries]
    try:
        before = path.read_text(encoding="utf-8") if path.exists() else _HEAD
        before += "" if before.endswith("\n") or not before else "\n"
        path.write_text("\n".join([before, *tables]), encoding="utf-8")
    except OSError as error:
        raise ConfigurationError(f"cannot be written: {error.strerror or error}", file=FILE) from error


def _written(texts: Mapping[str, str], date: datetime.date) -> str:
    lines = [f'{key} = "{_escaped(text)}"' for key, text in texts.items() if text]
    return "\n".join(["[[accept]]", *lines, f"date = {date.isoformat()}", ""])


def _escaped(text: str) -> str:
    signs = (_ESCAPES.get(sign, sign if sign.isprintable() else f"\\U{ord(sign):08x}") for sign in text)
    return "".join(signs)
