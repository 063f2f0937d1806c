"""From spans to sites: the text of a call and its number, as the file's language tells without running it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from mutabot.border.events import SiteSeen
from mutabot.languages.front_end import Name
from mutabot.languages.python import FRONT_END as PYTHON
from mutabot.languages.python import unused_calls
from mutabot.languages.registry import front_end_of
from mutabot.model import Role, Site, Span
from mutabot.model.alternative import Extent

from .writes import written_through


@dataclass(slots=True)
class Sources:
    """The project's source files, read when first needed.

    Attributes:
        root: the project's root.
    """

    root: Path
    _files: dict[str, Mapping[Extent, Name]] = field(default_factory=dict)
    _written: dict[str, frozenset[Extent]] = field(default_factory=dict)
    _unused: dict[str, frozenset[Extent]] = field(default_factory=dict)

    def site(self, seen: SiteSeen) -> Site:
        """The site at which something was seen."""
        span = seen.span
        names = self._files.get(span.file)
        if names is None:
            names = self._files[span.file] = self._names_in(span.file)
        text, occurrence = names.get(_extent(span), Name(f"line {span.line}", 1))
        return Site(span, text, occurrence, Role.ORACLE if seen.oracle else Role.PROGRAM)

    def is_written_through(self, span: Span) -> bool:
        """Whether the file writes to what an expression of it gives, as far as its text says."""
        if span.file not in self._written:
            self._written[span.file] = self._written_in(span.file)
        return _extent(span) in self._written[span.file]

    def _written_in(self, file: str) -> frozenset[Extent]:
        if front_end_of(file) is not PYTHON:
            return frozenset()
        try:
            return written_through((self.root / file).read_text(encoding="utf-8"))
        except (OSError, SyntaxError, ValueError):
            return frozenset()

    def is_unused(self, seen: SiteSeen) -> bool:
        """Whether nobody uses what the call returns: it is a statement by itself."""
        span = seen.span
        if not seen.direct or front_end_of(span.file) is not PYTHON:
            return False
        found = self._unused.get(span.file)
        if found is None:
            found = self._unused[span.file] = self._unused_in(span.file)
        return _extent(span) in found

    def _unused_in(self, file: str) -> frozenset[Extent]:
        try:
            return unused_calls((self.root / file).read_text(encoding="utf-8"))
        except (OSError, SyntaxError, ValueError):
            return frozenset()

    def _names_in(self, file: str) -> Mapping[Extent, Name]:
        """Names of all that may be a site; none for a file that cannot be read."""
        try:
            return front_end_of(file).names((self.root / file).read_text(encoding="utf-8"))
        except (OSError, SyntaxError, ValueError):
            return {}


def _extent(span: Span) -> Extent:
    return (span.line, span.column, span.end_line, span.end_column)
