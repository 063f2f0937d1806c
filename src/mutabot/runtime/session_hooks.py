"""Pytest's hooks for a job, which collect its tests and run them in this process or in copies of it."""

from __future__ import annotations

import atexit
import os
import sys
from collections.abc import Generator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import _pytest.pathlib
import pytest

import mutabot
from mutabot import extensions
from mutabot.frozen import compile_all
from mutabot.model import Mutant, Role
from mutabot.model.activation import FatalFault
from mutabot.model.events import SessionEnd
from mutabot.model.job import Job, read_job
from mutabot.operators.registry import preload
from mutabot.runtime import executed_text, fault_runner, seeds
from mutabot.runtime.event_file import EventFile, Held
from mutabot.runtime.interception.frames import is_ours
from mutabot.runtime.interception.trace import Locator
from mutabot.runtime.isolation.files import LOG, PrivateFiles
from mutabot.runtime.isolation.fork_parent import ForkParent
from mutabot.runtime.isolation.forkable import track_event_loops
from mutabot.runtime.isolation.namespaces import die_with_parent
from mutabot.runtime.meter import limit_memory
from mutabot.runtime.observation.checks import Checks
from mutabot.runtime.paths import BEGAN, watch_copies
from mutabot.runtime.processes.member import watch_forks
from mutabot.runtime.processes.members import Members
from mutabot.runtime.program_text.returns import Returns
from mutabot.runtime.seeds import node_id
from mutabot.runtime.session import Session
from mutabot.runtime.targets.target import prepare
from mutabot.runtime.test_end import classify, of_activity
from mutabot.runtime.test_hooks import ForkedRun, TestHooks

if TYPE_CHECKING:
    from mutabot.runtime.isolation.fork_server import ForkServer


#: the function of pluggy that calls hooks
_CALLS_HOOKS = "_multicall"


class SessionHooks:
    """Pytest's hooks for one job: the collection of its tests, and the session around them.

    Args:
        job: the job at hand.
        event_file: what takes the events; those of a server's session wait for its copies.
        server: forks a copy of this process for each job that comes; None if it runs its job itself.

    Attributes:
        tests: the hooks for each of its tests.
        config: pytest's configuration; None until it reads the first of the user's code.
    """

    _files: PrivateFiles

    def __init__(self, job: Job, event_file: EventFile, server: ForkServer | None = None) -> None:
        self.config: pytest.Config | None = None
        self._held = Held()
        self.locator = Locator(job.root, job.program, job.oracle)
        self.session = Session(job, event_file if server is None else self._held, self.locator)
        self.tests = TestHooks(self.session)
        self._server = server
        self._collected: tuple[str, ...] = ()
        self._errors: list[str] = []
        self._gone: tuple[str, ...] = ()
        self._pid = os.getpid()
        self._exit_status: int | None = None  # that of pytest, until the end is reported

    @property
    def job(self) -> Job:
        """The job at hand."""
        return self.session.job

    @classmethod
    def from_files(cls, job_file: str, descriptor: int) -> SessionHooks:
        """Read the job, set the limits of the process and put the interception in place."""
        die_with_parent(pipe=descriptor)
        home = os.path.dirname(os.path.dirname(job_file))
        job = read_job(home)
        extensions.use(job.extensions)
        watch_copies(job.root, job.program, BEGAN)
        executed_text.install()
        if job.memory is not None:
            limit_memory(job.memory)
        # what the program draws while it is imported is the same in all rounds: a server imports it once
        seeds.seed_all(seeds.derive(job.seed, "import"))
        event_file = EventFile.of_session(home, job.key, descriptor)
        if job.serving is not None:
            from mutabot.runtime.isolation import collector  # noqa: PLC0415  # of no use to others
            from mutabot.runtime.isolation.fork_server import ForkServer  # noqa: PLC0415

            collector.watch()
            if job.vocabulary.operations:  # else no operator of calls will act
                preload()
            own = LOG, home, job.private_files, not _tests_us(job)
            hooks = cls(job, event_file, ForkServer(job.serving, event_file, *own))
        else:
            hooks = cls(job, event_file)
            if job.pictures is not None:  # before its folder is hidden from this process
                hooks.session.recording.film(job.pictures)
            hooks._make_private(job, home)
        atexit.register(hooks._finish)  # before others, so that it is the last
        hooks.session.returns = Returns(hooks.locator)
        hooks.session.install()
        Checks(job.root, hooks._is_of_tests, hooks.tests.looks).install()
        hooks.session.call_sites.hook_pytest()
        hooks.tests.units.install()
        if job.serving is None:
            hooks._begin(home)
        return hooks

    def _make_private(self, job: Job, home: str) -> None:
        root = os.path.realpath(job.root)
        self._files = self.session.files = PrivateFiles(root, os.path.realpath(home))
        if job.private_files and self._files.make() is None:
            # it removes old folders of pytest's, which are there again for the next process
            _pytest.pathlib.cleanup_numbered_dir = lambda *_, **__: None
        die_with_parent()  # a process that changes its rights loses that wish

    def _begin(self, home: str) -> None:
        self._pid = os.getpid()
        job = self.job
        has_nodes = prepare(job.root, home, job.vocabulary.operations)
        members = self.tests.members = Members(home, self.session)
        watch_forks(members.folder, self.session)
        if job.mutant is not None:
            self.tests.left_out = job.left_out(job.mutant.id)
        compile_all()  # tests may take away what that needs (``sys.modules``, ``exec``)
        if job.forking is not None:
            preload({mutant.operator for mutant in job.forking.mutants})  # and not in every fork
            fault_runner.preload(job.active.values())
            track_event_loops()
            event_file, tests = self.session.writer, job.tests or ()
            assert isinstance(event_file, EventFile)
            more = (job.active, self._become, has_nodes, members.have_begun)
            self.session.grow(ForkParent(job.forking, tests, event_file, self._files, *more))

    def _become(self, mutant: Mutant, folder: str) -> None:
        """Continue as this mutant, in a process that was just forked."""
        assert self.session.fork_parent is not None
        self._pid = os.getpid()
        self.tests.start_clocks(is_new=True)
        self.tests.left_out = self.job.left_out(mutant.id)
        if self.config is not None:
            # a fork's traceback is not shown, and to lay one out takes longer than most forks
            self.config.option.tbstyle = "value"
            _keep_cache_in(self.config, folder)
        fork = ForkedRun(self.tests, self.session.fork_parent, mutant, self._files.home)
        self.session.become(mutant, fork.activation)

    def _is_of_tests(self, path: str) -> bool:
        """Return whether a file is the project's own, and not the program's."""
        return self.locator.is_of_project(path) and self.locator.role(path) is not Role.PROGRAM

    def seed_of(self, name: str) -> int:
        """Return the seed of a test or shared fixture in this round."""
        return seeds.derive(self.job.seed, self.job.round, name)

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Keep the job's tests, in the job's order, and those that the mutant has made."""
        self._collected = tuple(node_id(item) for item in items)
        self._select(items)

    def _select(self, items: list[pytest.Item]) -> None:
        if self.job.tests is None:
            return
        by_id = {node_id(item): item for item in items}
        alike = {node_id(item) for item in items if by_id[node_id(item)].nodeid != item.nodeid}
        self._errors += [f"several tests are called {name} once that is written in UTF-8" for name in alike]
        missing = [test for test in self.job.tests if test not in by_id]
        new: set[str] = set()
        if self.session.activity.acted:  # it is the mutant's doing, and for its suite to judge
            self._gone = tuple(missing)
            new = by_id.keys() - {*self.job.tests, *self.job.aside}
        elif missing:
            self._errors.append(f"tests that were there before are gone: {', '.join(missing)}")
        known = new.union(self.job.tests)
        items[:] = [
            by_id[test] for test in (by_id if new else self.job.tests) if test in by_id and test in known
        ]

    @pytest.hookimpl(wrapper=True)
    def pytest_make_collect_report(
        self, collector: pytest.Collector
    ) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
        """Note whether the mutant or the tests caused an error of collection."""
        report = yield
        call: pytest.CallInfo[Any] | None = getattr(report, "call", None)
        if report.failed and call is not None and call.excinfo is not None:
            error = call.excinfo.value
            is_wrapped = isinstance(error, collector.CollectError) and error.__cause__ is not None
            self.import_failed(error.__cause__ if is_wrapped else error, node_id(collector))
        return report

    def import_failed(self, error: BaseException | None, node: str) -> None:
        """Report test files that cannot be imported; a mutant that acted meanwhile was noticed.

        Args:
            error: what was raised.
            node: id of what could not be collected; empty for all there is.
        """
        activity = self.session.activity
        if error is None or not activity.acted:
            return
        below = (f"{node}::", f"{node}/") if node not in ("", ".") else ("",)
        tests = [test for test in self.job.tests or () if test.startswith(below)]
        for test in tests[:1] if self.job.stop_at_kill else tests:
            file = os.path.join(self.job.root, test.partition("::")[0])
            end = classify(error, test, file, self.locator, self.job.vocabulary, activity)
            end = replace(end, **of_activity(end, activity))
            if self.tests.fork is not None:
                self.tests.fork.end_test(end)
            else:
                self.session.writer.send(end)

    def pytest_internalerror(self, excinfo: pytest.ExceptionInfo[BaseException]) -> None:
        """Report a hook that fails: ours, or one that noticed a mutant which acted before any test."""
        if _is_own_failure(excinfo):
            self._errors.append(f"mutabot failed: {excinfo.exconly()}")
        elif not self.session.test:
            self.import_failed(excinfo.value, "")

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Note what could not be collected."""
        if report.failed:
            self._errors.append(f"{node_id(report)}: {str(report.longrepr)[-1500:]}")

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> Generator[None, Any, Any]:
        """Run the collected tests, or fork a copy of this process for every job."""
        self.session.note_modules()  # before any copy is made of this process
        request = self._server.serve(self.tests.units.has_started) if self._server is not None else None
        if request is not None:
            self._take_on(session, *request)
        if self._server is not None:
            session.items.clear()
        else:
            seeds.seed_all(seeds.derive(self.job.seed, self.job.round, "session"))
        result = yield
        # hypothesis's plugin imports all of hypothesis for its summary, even if no test has used it
        manager = session.config.pluginmanager
        if "hypothesis" not in sys.modules and (plugin := manager.get_plugin("hypothesispytest")) is not None:
            manager.unregister(plugin)
        return result

    def _take_on(self, session: pytest.Session, home: str, descriptor: int) -> None:
        """Become the session of a job, in a copy of a fork server."""
        self._server = None
        job = read_job(home)
        self._make_private(job, home)
        event_file = EventFile.of_session(home, job.key, descriptor)
        self.session.take_on(job, event_file)
        for event in self._held.events:
            event_file.send(event)
        self._select(session.items)
        _keep_cache_in(session.config, home)
        self._begin(home)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item, nextitem: pytest.Item | None) -> bool | None:
        """Tear down fixtures that end with a test that is left out, instead of running it."""
        if node_id(item) not in self.tests.left_out:
            return None
        item.session._setupstate.teardown_exact(nextitem)
        return True

    @pytest.hookimpl(tryfirst=True)
    def pytest_sessionfinish(self, exitstatus: int) -> None:
        """Note that all tests have run; hooks and exit handlers may still make calls, or leave at once."""
        leave = os._exit

        def leave_at_once(status: int) -> NoReturn:
            try:
                self._finish()
            finally:
                leave(status)

        self._exit_status = int(exitstatus)
        os._exit = leave_at_once
        self.tests.note_end_of_phases()

    def _finish(self) -> None:
        """Report, as the process ends, what was observed."""
        if self._exit_status is None or self._server is not None or self._pid != os.getpid():
            return
        exit_status, self._exit_status = self._exit_status, None
        self.tests.end_test()
        if self.tests.fork is not None:
            self.tests.fork.finish(self._errors, self._gone)
            return
        members = self.tests.members
        self.session.finish(members.texts_seen() if members is not None else ())
        if members is not None and members.children.doubt is not None:
            self._errors.append(members.children.doubt)
        not_private = self._files.why_not if self.job.private_files else None
        facts = (self._collected, tuple(self._errors), not_private, self._gone)
        self.session.writer.send(SessionEnd(exit_status, *facts, self.session.activity.acted > 0))


def _is_own_failure(excinfo: pytest.ExceptionInfo[BaseException]) -> bool:
    """Return whether our code fails: it has raised, or the hook that did, with what it calls, is ours.

    Hooks of ours around that hook are on the way of the exception as well, but farther out. What a control
    raises is meant.
    """
    if isinstance(excinfo.value, FatalFault):
        return False
    frames = [entry.frame.raw for entry in excinfo.traceback]
    calls = [number for number, frame in enumerate(frames) if frame.f_code.co_name == _CALLS_HOOKS]
    return any(map(is_ours, [frames[-1], *frames[calls[-1] + 1 :][:1]] if calls else frames[-1:]))


def _keep_cache_in(config: pytest.Config, home: str) -> None:
    """Give the process a cache folder of its own, as other processes must not find its entries."""
    cache = getattr(config, "cache", None)
    if cache is not None:
        cache._cachedir = Path(home, "cache")


def _tests_us(job: Job) -> bool:
    """Return whether the program contains parts of mutabot, whose results must not be cached."""
    home = Path(mutabot.__file__).resolve().parent.parent
    if home.name == "site-packages":
        return False
    ours = list(home.glob("mutabot*"))
    parts = [Path(job.root, part).resolve() for part in (*job.program, *job.oracle)]
    return any(path.is_relative_to(part) or part.is_relative_to(path) for part in parts for path in ours)
