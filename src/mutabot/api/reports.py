"""What reports and commands read: results of a campaign, its outcomes and recordings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mutabot.lazy import lazily

if TYPE_CHECKING:
    from mutabot.errors import UsageError
    from mutabot.model.outcome import Outcome, Verdict
    from mutabot.results.results import MutantResult, Results

__all__ = [
    "MutantResult",
    "Outcome",
    "Results",
    "UsageError",
    "Verdict",
]
_HOMES = {
    "mutabot.errors": ("UsageError",),
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
