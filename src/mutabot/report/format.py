"""The contract of a format: a function that returns a text about a campaign.

A format is the function ``make`` of a file in ``report/formats``; it has the file's name, with hyphens. It is
found there, and nothing else has to be edited. Packages bring others (``extensions.Extension``). What it is
given has no absolute path and no character that no format could hold (``report.texts.portable``); what is
special in the format it escapes itself.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.errors import UsageError, unknown_name_text
from mutabot.extensions import brought
from mutabot.frozen import frozen
from mutabot.results.results import Results

if TYPE_CHECKING:
    from mutabot.model import Span


@frozen
class Material:
    """The input of a format.

    Attributes:
        campaign: the campaign, fit for any report.
        prefix: the project's folder in its repository, with forward slashes; empty if that is its root.
    """

    campaign: Results
    prefix: str = ""

    def path(self, file: str) -> str:
        """Return a file of the project, relative to the repository."""
        return f"{self.prefix}/{file}" if self.prefix else file

    def place(self, span: Span, length: Callable[[str], int] = len) -> FilePlace:
        """Return the position of a span in its file; ``length`` is the count of characters within a line."""
        return place_of(span, self.campaign.source(span.file), length)


#: makes the text of a whole report
Format = Callable[[Material], str]


@frozen
class FilePlace:
    """A place in a file.

    Attributes:
        line, end_line: from 1.
        column: from 1; 1 if the text is not known.
        end_column: from 1, of the first character behind it; None if the text is not known.
        text: what stands there; None if it is not known.
    """

    line: int
    column: int
    end_line: int
    end_column: int | None
    text: str | None


def utf16(text: str) -> int:
    """Return the length of a text in UTF-16 code units, as JavaScript and SARIF count."""
    return len(text.encode("utf-16-le", errors="replace")) // 2


def place_of(span: Span, source: str | None, length: Callable[[str], int] = len) -> FilePlace:
    """Return the position of a span in its source; ``length`` is the count of characters within a line.

    Other tools know no place without a line: what does not stand in the text is reported at the first one.
    """
    lines = source.split("\n") if source is not None else []
    if not 1 <= span.line <= span.end_line <= len(lines):
        line = max(span.line, 1)
        return FilePlace(line, 1, max(line, span.end_line), None, None)
    before = _prefix(lines[span.line - 1], span.column)
    whole = _prefix(lines[span.end_line - 1], span.end_column)
    shown = [*lines[span.line - 1 : span.end_line - 1], whole]
    shown[0] = shown[0][len(before) :]
    return FilePlace(span.line, length(before) + 1, span.end_line, length(whole) + 1, "\n".join(shown))


def _prefix(line: str, column: int) -> str:
    """Return the part of a line before a column, which counts UTF-8 bytes from 0."""
    return line.encode(errors="replace")[:column].decode(errors="ignore")


def names() -> list[str]:
    """Return the names of all formats."""
    return sorted([*_own(), *brought("formats", _own())])


def format_of(name: str) -> Format:
    """Return the format of this name. Raises UsageError, with the nearest name, if there is none."""
    if name in _own():
        module = importlib.import_module(f"{__package__}.formats.{name.replace('-', '_')}")
        return module.make  # type: ignore[no-any-return]
    part = brought("formats", _own()).get(name)
    if part is None:
        pages = "; pages for a browser: --html DIR" if name.casefold() == "html" else ""
        raise UsageError(f"{unknown_name_text('format', name, names())}{pages}")
    return part.load_function()


def _own() -> list[str]:
    found = (module.name for module in pkgutil.iter_modules([str(Path(__file__).with_name("formats"))]))
    return [name.replace("_", "-") for name in found if not name.startswith("_")]
