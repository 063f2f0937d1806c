"""What reports and commands read: results of a campaign, its outcomes and recordings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.campaign.again import CampaignRun
    from mutabot.campaign.request import Progress
    from mutabot.cli.context import CommandContext
    from mutabot.errors import MutabotError, UsageError
    from mutabot.evidence.paths import RecordedPaths
    from mutabot.model.outcome import Verdict
    from mutabot.report.html.pages import ReportPages
    from mutabot.results.results import MutantResult, Results

__all__ = [
    "CampaignRun",
    "CommandContext",
    "MutabotError",
    "MutantResult",
    "Progress",
    "RecordedPaths",
    "ReportPages",
    "Results",
    "UsageError",
    "Verdict",
]
_HOMES = {
    "mutabot.campaign.again": ("CampaignRun",),
    "mutabot.campaign.request": ("Progress",),
    "mutabot.cli.context": ("CommandContext",),
    "mutabot.errors": (
        "MutabotError",
        "UsageError",
    ),
    "mutabot.evidence.paths": ("RecordedPaths",),
    "mutabot.model.outcome": ("Verdict",),
    "mutabot.report.html.pages": ("ReportPages",),
    "mutabot.results.results": (
        "MutantResult",
        "Results",
    ),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
