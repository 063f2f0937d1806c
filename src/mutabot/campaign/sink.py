"""Where outcomes go: into the journal, each with the key of what it depends on."""

from __future__ import annotations

from collections.abc import Callable

from mutabot.frozen import frozen
from mutabot.journal.journal import Journal
from mutabot.model import Outcome


def _no_key(outcome: Outcome) -> str:
    return ""


@frozen
class Sink:
    """The journal of a campaign, for whoever finds outcomes.

    Attributes:
        journal: where they go.
        key_of: what an outcome depends on. The empty key says that nobody knows, and that it is not to be
            reused.
    """

    journal: Journal
    key_of: Callable[[Outcome], str] = _no_key

    def add_outcome(self, outcome: Outcome) -> None:
        """Add one outcome; a later one of the same mutant and round takes its place."""
        self.journal.add_outcome(outcome, key=self.key_of(outcome))
