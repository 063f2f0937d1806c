"""Where mutants can act: a site, with its operation and text command where calls are made there."""

from __future__ import annotations

from dataclasses import dataclass

from .mutant import Mutant
from .site import Site


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """Where and what a mutant can act on.

    Attributes:
        site: where.
        operation: the operation that is called there; empty where the place is none of a call.
        pattern: the text command.
    """

    site: Site
    operation: str
    pattern: str | None = None

    @classmethod
    def of(cls, mutant: Mutant) -> Place:
        """Where a mutant of the first order acts."""
        return cls(mutant.site, mutant.operation, mutant.pattern)

    @property
    def key(self) -> str:
        """The same place in words, equal between processes."""
        span = self.site.span
        columns = f"{span.line}:{span.column}-{span.end_line}:{span.end_column}"
        return f"{span.file}:{columns} {self.operation} {self.pattern or ''}".rstrip()
