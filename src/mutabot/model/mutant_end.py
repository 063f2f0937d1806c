"""The outcome of a mutant, as a campaign reports it when it enters the journal."""

from __future__ import annotations

from mutabot.frozen import frozen

from .mutant import Mutant
from .outcome import Outcome, Verdict
from .suppression import Acceptance


@frozen
class MutantEnd:
    """The end of a mutant in a round. A later one of the same mutant and round takes its place.

    Attributes:
        mutant: the mutant.
        outcome: how it ended.
        acceptance: why it is accepted if it survives; None if it is not.
        is_reused: whether an earlier campaign found it.
    """

    mutant: Mutant
    outcome: Outcome
    acceptance: Acceptance | None = None
    is_reused: bool = False

    @property
    def state(self) -> str:
        """The state that it is counted as: its verdict, or *accepted*."""
        verdict = self.outcome.verdict
        is_let_through = verdict in (Verdict.SURVIVED, Verdict.NOT_COVERED)
        return "accepted" if is_let_through and self.acceptance is not None else str(verdict)
