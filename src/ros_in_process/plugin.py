"""A pytest plug-in that runs a suite over simulated ROS 2: `python -m pytest -p ros_in_process.plugin`.

`--ros-schedule random --ros-seed 7` draws the order of ready callbacks. The same seed gives the same order.
`ROS_IN_PROCESS_SCHEDULE` and `ROS_IN_PROCESS_SEED` in the environment do the same.
"""

from __future__ import annotations

import argparse
import gc
import getpass
import os
import tempfile
from collections.abc import Iterator

import pytest

import ros_in_process
from ros_in_process.errors import NeedsRealRos, note
from ros_in_process.machine.scheduler import SCHEDULER, SECOND
from ros_in_process.settings import SETTINGS

#: simulated seconds after which a test counts as stuck
LIMIT = 3600


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("simulated ROS")
    group.addoption(
        "--ros-schedule",
        choices=("first-in", "random"),
        default=os.environ.get("ROS_IN_PROCESS_SCHEDULE", "first-in"),
        help="the order in which callbacks and threads that are ready go on",
    )
    group.addoption(
        "--ros-seed",
        type=int,
        default=int(os.environ.get("ROS_IN_PROCESS_SEED", "0")),
        help="what a random order is drawn from",
    )
    group.addoption(
        "--ros-strict",
        action="store_true",
        help="a test that meets what is not simulated fails, even if the program catches the error",
    )


def pytest_report_header(config: pytest.Config) -> list[str]:
    """Return a line with the random order's seed, which reproduces the order."""
    schedule, seed = config.getoption("ros_schedule"), config.getoption("ros_seed")
    return [f"simulated ROS: --ros-schedule random --ros-seed {seed}"] if schedule == "random" else []


def _written_by_tests() -> str:
    """Return the folder that contains those of the fixture `tmp_path`."""
    try:
        user = getpass.getuser()
    except (ImportError, KeyError, OSError):  # a container may know no user; pytest has this word then
        user = "unknown"
    return os.path.join(tempfile.gettempdir(), f"pytest-of-{user}")


@pytest.hookimpl(tryfirst=True)
def pytest_load_initial_conftests(early_config: pytest.Config) -> None:
    """Start before the project's first module is imported."""
    _start(early_config, early_config.known_args_namespace)


def pytest_configure(config: pytest.Config) -> None:
    """Start if a conftest names this plug-in; then nothing imported so far may wait."""
    if not ros_in_process.is_running():
        _start(config, config.option)


def _start(config: pytest.Config, options: argparse.Namespace) -> None:
    SETTINGS.is_strict |= options.ros_strict
    # programs that tests write for themselves are the project's, too
    roots = [str(config.rootpath), str(config.invocation_params.dir), _written_by_tests()]
    try:
        ros_in_process.start(roots, options.ros_schedule, options.ros_seed)
    except NeedsRealRos as error:
        raise pytest.UsageError(str(error)) from None


def pytest_collection_finish(session: pytest.Session) -> None:
    """Exclude existing objects from garbage collection before the first test."""
    if any(item.get_closest_marker(name) for item in session.items for name in ("asyncio", "anyio")):
        note("tests that are coroutines run in an event loop of a plug-in's, in real time")
    gc.collect()
    gc.freeze()


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Limit each test's simulated time, and free memory at the same moments in each run.

    The release of nodes and futures is observable: if that came at any moment, equal runs would differ.
    """
    SCHEDULER.limit = SCHEDULER.now + LIMIT * SECOND
    SCHEDULER.schedule.begin(f"{SETTINGS.seed_of(item)} {item.nodeid}")
    was_enabled = gc.isenabled()
    gc.collect()
    gc.disable()
    try:
        return (yield)
    finally:
        SCHEDULER.limit = None
        if was_enabled:
            gc.enable()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call() -> Iterator[None]:
    """In strict mode, fail a test that met something not simulated, even if the error was caught."""
    known = len(ros_in_process.reasons())
    try:
        return (yield)
    finally:
        new = ros_in_process.reasons()[known:]
        if new and SETTINGS.is_strict:
            raise NeedsRealRos(new[0])


#: fixtures run the program as well
pytest_runtest_setup = pytest_runtest_teardown = pytest_runtest_call


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Report what the simulation could not do."""
    for reason in ros_in_process.reasons():
        terminalreporter.write_line(f"needs real ROS: {reason}", yellow=True)


class SimulatedTime:
    """Simulated time, for tests that wait for nodes."""

    @property
    def seconds(self) -> float:
        """The simulated time, in seconds; it never goes back."""
        return SCHEDULER.advanced()

    def advance(self, seconds: float) -> None:
        """Let nodes run for this long in simulated time, in seconds. Raises ValueError if it is negative."""
        if seconds < 0:
            raise ValueError(f"{seconds} s: simulated time does not go back")
        SCHEDULER.sleep(round(seconds * SECOND))


@pytest.fixture
def simulated_time() -> SimulatedTime:
    """Return the time in which the nodes of this process run."""
    return SimulatedTime()
