"""Tests that are left out: those that do not reach the mutant, once one has reached it.

What they would have done is not known then: what is found without them is confirmed by the whole suite, or
said to be not. Fixtures live as long as in the whole suite.
"""

from __future__ import annotations

from collections.abc import Iterable

import pytest

from mutabot.border.job import Job
from mutabot.inside.node_ids import node_id


class LeftOut:
    """Which tests this process leaves out, and pytest's hook by which it does."""

    def __init__(self) -> None:
        self._left_out: frozenset[str] = frozenset()

    def become(self, job: Job, mutants: Iterable[str]) -> None:
        """This process is these mutants from now on: what reaches one of them is run."""
        self._left_out = frozenset.intersection(*(job.left_out(mutant) for mutant in mutants))

    def is_next(self, test: str) -> bool:
        """Whether the test that is about to begin is left out."""
        return test in self._left_out

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item, nextitem: pytest.Item | None) -> bool | None:
        """In place of running such a test: take down what ends with it."""
        if not self.is_next(node_id(item)):
            return None
        item.session._setupstate.teardown_exact(nextitem)
        return True
