"""The active fault of mutants of calls, which act where the dispatcher meets their site."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from mutabot.runtime.active_fault import ActiveFault
from mutabot.runtime.interception.active_mutant import MutatedSite

if TYPE_CHECKING:
    from random import Random

    from mutabot.model import Mutant
    from mutabot.runtime.activity import Activity
    from mutabot.runtime.session import Session


class CallMutant(ActiveFault):
    """A mutant of calls in this process."""

    context: Session
    is_checked: ClassVar[bool] = False

    def __init__(self, mutant: Mutant, data: Any, context: Session) -> None:
        super().__init__(mutant, data, context)
        self._is_early = not context.test
        operation = context.job.vocabulary.operation(mutant.operation)
        assert operation is not None, "mutants of calls are planned for the vocabulary of their job"
        operation = operation.by_numbers() if mutant.by_number else operation
        context_facts = (context.acted_in_call, context.in_mutated_call, lambda: context.seconds)
        self._active = MutatedSite(mutant, operation, context.refusals_of(operation), *context_facts)

    def prepare_process(self) -> None:
        """Activate the mutant: calls while the program is imported count for all tests."""
        self.context.dispatcher.mutant = self._active
        if self._is_early:
            self._start()

    def start_test(self, test: str, random: Random) -> None:
        """Begin a test, or continue it in this process, which was forked in it."""
        if self._is_early:
            self._active.early = self._active.activity
        self._is_early = False
        self._start()

    def _start(self) -> None:
        context, mutant = self.context, self.mutant
        usual = context.dispatcher.refused.at(mutant.site.span, mutant.operation, mutant.pattern)
        seed, moment = context.seed_of(mutant), context.moment_of(mutant)
        self._active.start(seed, context.round, context.test, moment, usual)

    def end_test(self) -> None:
        """Leave the mutant active, since calls between tests are mutated as well."""

    @property
    def activity(self) -> Activity:
        """What the mutant did in the running test."""
        self._active.look_back()
        return self._active.activity
