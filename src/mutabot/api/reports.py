"""The interface for packages that read results: reports, commands, outcomes and recordings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.campaign.partial_runs import CampaignRun as CampaignRun
    from mutabot.campaign.request import Progress as Progress
    from mutabot.cli.context import CommandContext as CommandContext
    from mutabot.errors import MutabotError as MutabotError
    from mutabot.errors import UsageError as UsageError
    from mutabot.evidence.paths import RecordedPaths as RecordedPaths
    from mutabot.model.outcome import Verdict as Verdict
    from mutabot.report.html.pages import LiveReport as LiveReport
    from mutabot.results.results import MutantResult as MutantResult
    from mutabot.results.results import Results as Results

_HOMES = {
    "mutabot.campaign.partial_runs": ("CampaignRun",),
    "mutabot.campaign.request": ("Progress",),
    "mutabot.cli.context": ("CommandContext",),
    "mutabot.errors": ("MutabotError", "UsageError"),
    "mutabot.evidence.paths": ("RecordedPaths",),
    "mutabot.model.outcome": ("Verdict",),
    "mutabot.report.html.pages": ("LiveReport",),
    "mutabot.results.results": ("MutantResult", "Results"),
}
__getattr__ = lazily(__name__, _HOMES)
