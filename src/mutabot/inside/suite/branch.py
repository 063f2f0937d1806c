"""A branch: a process that was forked in the middle of a test, finishes it as its mutant, and leaves."""

from __future__ import annotations

import gc
import os
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from mutabot.border.events import BranchEnd, Unbranched
from mutabot.border.test_end import TestEnd
from mutabot.inside.footprint.deeds import Deed
from mutabot.inside.footprint.footprints import Footprints
from mutabot.inside.fork.bunch import Bunch
from mutabot.inside.fork.lifeline import die_with_parent
from mutabot.inside.fork.trunk import ALIVE, DECIDED, FAILED, STOPPED
from mutabot.inside.session import Session

from . import classify


class BranchOfTest:
    """What the trunk's process does where it turns out to be a branch; see ``inside.fork.trunk.Branch``.

    Args:
        session: the job at hand.
        footprints: what tests leave.
        start_clocks: lets what the test takes count from now on.

    Attributes:
        item: the running test.
    """

    def __init__(self, session: Session, footprints: Footprints, start_clocks: Callable[[], None]) -> None:
        self.item: pytest.Item | None = None
        self._session = session
        self._footprints = footprints
        self._start_clocks = start_clocks
        self._trunk = 0
        self._bunch: Bunch | None = None
        self._shared: float | None = None

    def expect(self) -> None:
        """This process is a trunk from now on."""
        self._trunk = os.getpid()

    def begin(self) -> None:
        """Right after the fork: take down nothing that is shared when the test is over."""
        die_with_parent(self._trunk)
        self._start_clocks()
        meter = self._session.meter
        self._shared = meter.simulated if meter is not None else None
        assert self.item is not None
        keep_shared_fixtures(self.item)
        self._footprints.files.on_deed = self._leave_before
        gc.freeze()  # what is never looked at stays shared with the trunk
        # nobody reads a branch's traceback, and to lay one out takes longer than most branches
        self.item.config.option.tbstyle = "value"

    def become(self, bunch: Bunch) -> None:
        """Go on from here as these mutants."""
        self._bunch, self._trunk = bunch, os.getpid()  # from which others may part
        self._session.become(bunch)

    def leave_if_it_is_one(self, end_of_test: Callable[[], TestEnd] | None) -> None:
        """The test is over: a branch reports and goes, without running anything of the trunk's.

        ``end_of_test`` tells how the test has ended; None if it was torn off.
        """
        if self._bunch is None:
            return
        code = FAILED
        try:
            if end_of_test is not None:
                code = self._report(self._bunch, end_of_test())
        finally:  # whatever happens, the trunk's code must not run on in this process
            os._exit(code)

    def _report(self, bunch: Bunch, end: TestEnd) -> int:
        """Say how the test of this branch ended; returns the exit code that tells the trunk."""
        sites = self._session.recorder.sites_of_trace() if end.outcome != classify.FAILED else ()
        if end.outcome == classify.FAILED:  # only survivors are compared with the original
            end = replace(end, trace=(), returned=(), moments=())
        code = DECIDED if end.is_decided else ALIVE
        mutants = bunch.end(code)
        each = 1 / len(mutants)  # they share what it took
        end = replace(end, wall=(end.wall - bunch.waited) * each, cpu=end.cpu * each)
        for number, mutant in enumerate(mutants):  # the first one was simulated, for all of them
            self._session.pipe.send(BranchEnd(mutant, end, sites, end.simulated if number else self._shared))
        return code

    def _leave_before(self, deed: Deed) -> None:
        """A branch is about to do what the original does not, and what others would notice: it leaves."""
        mutants = self._bunch.end(STOPPED) if self._bunch is not None else [""]
        try:
            self._session.pipe.send(
                Unbranched(self._session.test, tuple(mutants), f"with a mutant, it {deed}")
            )
        finally:
            os._exit(STOPPED)


class _Parent:
    """Stands for a next test in the same place: nothing above the present test is taken down for it."""

    def __init__(self, item: pytest.Item) -> None:
        self._chain = item.listchain()[:-1]

    def listchain(self) -> list[Any]:
        return self._chain


def keep_shared_fixtures(item: pytest.Item) -> None:
    """Let the teardown of this test take down what is the test's own, and nothing that others share."""
    state = item.session._setupstate
    teardown = state.teardown_exact

    def teardown_own(nextitem: pytest.Item | None) -> None:
        teardown(_Parent(item))  # type: ignore[arg-type]  # only its chain is looked at

    state.teardown_exact = teardown_own  # type: ignore[method-assign]  # in this process alone
