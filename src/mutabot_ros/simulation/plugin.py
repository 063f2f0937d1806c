"""A pytest plug-in that runs a suite over simulated ROS: `python -m pytest -p mutabot_ros.simulation.plugin`.

`--ros-schedule random --ros-seed 7` draws the order of ready callbacks. The same seed gives the same order,
and each round of a campaign has another.
`MUTABOT_ROS_SCHEDULE` and `MUTABOT_ROS_SEED` in the environment do the same.
"""

from __future__ import annotations

import gc
import getpass
import os
import tempfile
from collections.abc import Iterator

import pytest

from mutabot.model.event_file import VARIABLE
from mutabot_ros import simulation
from mutabot_ros.simulation.machine.scheduler import SCHEDULER, SECOND, NeedsRealRos, note

#: simulated seconds after which a test counts as stuck
LIMIT = 3600


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("simulated ROS")
    group.addoption(
        "--ros-schedule",
        choices=("first-in", "random"),
        default=os.environ.get("MUTABOT_ROS_SCHEDULE", "first-in"),
        help="the order in which callbacks and threads that are ready go on",
    )
    group.addoption(
        "--ros-seed",
        type=int,
        default=int(os.environ.get("MUTABOT_ROS_SEED", "0")),
        help="what a random order is drawn from",
    )


def pytest_report_header(config: pytest.Config) -> list[str]:
    """Say which order is drawn: its seed gives it again."""
    schedule, seed = config.getoption("ros_schedule"), config.getoption("ros_seed")
    return [f"simulated ROS: --ros-schedule random --ros-seed {seed}"] if schedule == "random" else []


def _written_by_tests() -> str:
    """Where the fixture `tmp_path` has its folders."""
    try:
        user = getpass.getuser()
    except (ImportError, KeyError, OSError):  # a container may know no user; pytest has this word then
        user = "unknown"
    return os.path.join(tempfile.gettempdir(), f"pytest-of-{user}")


@pytest.hookimpl(tryfirst=True)
def pytest_load_initial_conftests(early_config: pytest.Config) -> None:
    """Start before the project's first module is imported."""
    options = early_config.known_args_namespace
    # programs that tests write for themselves are the project's, too
    roots = [str(early_config.rootpath), str(early_config.invocation_params.dir), _written_by_tests()]
    try:
        simulation.start(roots, options.ros_schedule, options.ros_seed)
    except NeedsRealRos as error:
        raise pytest.UsageError(str(error)) from None


def pytest_collection_finish(session: pytest.Session) -> None:
    """Let the collector of garbage pass over what is there before the first test."""
    if any(item.get_closest_marker(name) for item in session.items for name in ("asyncio", "anyio")):
        note("tests that are coroutines run in an event loop of a plug-in's, in real time")
    gc.collect()
    gc.freeze()


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Let no test run for ever in simulated time, and free memory at the same moments in each run.

    Nodes and futures that are freed are told of: if that came at any moment, equal runs would differ.
    """
    SCHEDULER.limit = SCHEDULER.now + LIMIT * SECOND
    SCHEDULER.schedule.begin(f"{_seed_of_round(item)} {item.nodeid}")
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
    """In a campaign, a test that met what is not simulated says nothing, also where the error was caught."""
    known = len(simulation.reasons())
    try:
        return (yield)
    finally:
        new = simulation.reasons()[known:]
        if new and VARIABLE in os.environ:
            raise NeedsRealRos(new[0])


#: fixtures run the program as well
pytest_runtest_setup = pytest_runtest_teardown = pytest_runtest_call


def _seed_of_round(item: pytest.Item) -> int:
    """What a campaign draws from in this round: another order in each."""
    from mutabot.runtime.pytest_plugin import seed_of  # noqa: PLC0415  # pytest itself imports it first

    return seed_of(item)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say what the simulation could not do."""
    for reason in simulation.reasons():
        terminalreporter.write_line(f"needs real ROS: {reason}", yellow=True)
