"""The contract of a format: what it is called, and what makes it of a campaign.

A format is one file in ``report/formats``, which sets ``FORMAT``; it has the file's name, with hyphens. It is
found there, and nothing else has to be edited. Packages bring others (``extensions.Extension``). What it is
given has no absolute path and no character that no format could hold (``report.shaping.portable``); what is
special in the format it escapes itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mutabot.analysis.stored.campaign import StoredCampaign
from mutabot.analysis.stored.changes import Changes
from mutabot.model import Span
from mutabot.report.shaping.places import Place, place_of


@dataclass(frozen=True, slots=True)
class Material:
    """What a format is made from.

    Attributes:
        campaign: the campaign, fit for any report.
        prefix: the project's folder in its repository, with forward slashes; empty if that is its root.
        changes: what differs from an older campaign, if that is to be told.
    """

    campaign: StoredCampaign
    prefix: str = ""
    changes: Changes | None = None

    def path(self, file: str) -> str:
        """A file of the project, relative to the repository."""
        return f"{self.prefix}/{file}" if self.prefix else file

    def place(self, span: Span, length: Callable[[str], int] = len) -> Place:
        """Where a span is. ``length`` counts the characters of a part of a line."""
        return place_of(span, self.campaign.source(span.file), length)


@dataclass(frozen=True, slots=True)
class Format:
    """A format.

    Attributes:
        name: by which users ask for it.
        make: the text of the whole report.
        tells_changes: whether it can hold what differs from an older campaign.
    """

    name: str
    make: Callable[[Material], str]
    tells_changes: bool = False
