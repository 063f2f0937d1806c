"""What reports and commands read: results of a campaign, its outcomes and recordings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.campaign.request import Progress
    from mutabot.cli.context import CommandContext
    from mutabot.errors import MutabotError, UsageError
    from mutabot.model.mutant_end import MutantEnd
    from mutabot.model.outcome import Outcome, Verdict
    from mutabot.results.results import MutantResult, Results
    from mutabot.results.suggested import Suggestion

__all__ = [
    "CommandContext",
    "MutabotError",
    "MutantEnd",
    "MutantResult",
    "Outcome",
    "Progress",
    "Results",
    "Suggestion",
    "UsageError",
    "Verdict",
]
_HOMES = {
    "mutabot.campaign.request": ("Progress",),
    "mutabot.cli.context": ("CommandContext",),
    "mutabot.errors": (
        "MutabotError",
        "UsageError",
    ),
    "mutabot.model.mutant_end": ("MutantEnd",),
    "mutabot.model.outcome": (
        "Outcome",
        "Verdict",
    ),
    "mutabot.results.results": (
        "MutantResult",
        "Results",
    ),
    "mutabot.results.suggested": ("Suggestion",),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
