"""What reports and commands read: results of a campaign, its outcomes and recordings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.cli.output import echo
    from mutabot.errors import MutabotError, UsageError
    from mutabot.model.outcome import Outcome, Verdict
    from mutabot.results.results import MutantResult, Results

__all__ = [
    "MutabotError",
    "MutantResult",
    "Outcome",
    "Results",
    "UsageError",
    "Verdict",
    "echo",
]
_HOMES = {
    "mutabot.cli.output": ("echo",),
    "mutabot.errors": (
        "MutabotError",
        "UsageError",
    ),
    "mutabot.model.outcome": (
        "Outcome",
        "Verdict",
    ),
    "mutabot.results.results": (
        "MutantResult",
        "Results",
    ),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
