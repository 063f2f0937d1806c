"""Campaigns that choose between real ROS 2 and the simulation, and hold some outcomes against real ROS 2."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from campaign.project import CONFIGURATION, Quiet, outcomes, request_for, write_project
from mutabot.campaign.partial_runs import replay_one
from mutabot.campaign.run import run_campaign
from mutabot.cli.request import request_again
from mutabot.config.configuration import load_configuration
from mutabot.journal.reader import JournalReader
from mutabot.model import Verdict
from mutabot.report.sections import sections
from mutabot.results.gate import decide
from mutabot.results.results import Results, read_results

pytestmark = [
    pytest.mark.skipif(
        find_spec("rclpy") is None or find_spec("greenlet") is None,
        reason="no ROS 2 with greenlet: pip install -r requirements-ros2.lock",
    ),
    pytest.mark.usefixtures("plugins"),
]

MISSION = """
    from std_msgs.msg import Float64

    def run(publisher):
        publisher.publish(Float64(data={value}))
"""
TESTS = """
    import time
    import pytest
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from std_msgs.msg import Float64
    import ros_in_process
    import mission

    def heard(act):
        context = rclpy.Context()
        rclpy.init(context=context)
        node = rclpy.create_node("mission", context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        found = []
        publisher = node.create_publisher(Float64, "/speed", 10)
        node.create_subscription(Float64, "/speed", lambda one: found.append(one.data), 10)
        while not node.count_subscribers("/speed") or not publisher.get_subscription_count():
            executor.spin_once(0.1)
        act(publisher)
        until = time.monotonic() + 5.0
        while not found and time.monotonic() < until:
            executor.spin_once(0.1)
        executor.shutdown()
        context.shutdown()
        return found[:1]

    def test_it_shows_the_speed():
        {check}
"""
CHECK = "assert heard(mission.run) == [0.5]"
VOCABULARY = """
    [[operation]]
    topic = "/speed"
    direction = "publish"
    type = "std_msgs/Float64"
    fields.data = { kind = "speed", axis = "x", unit = "m/s" }
"""


def campaign(folder: Path, check: str = CHECK, value: str = "0.5", **changes: Any) -> Results:
    """The results of a campaign of one mutant, the reversed speed."""
    write_project(folder, MISSION.format(value=value), TESTS.format(check=check), vocabulary=VOCABULARY)
    changes = {"rounds": 1, "only": ("*reverse*",), "jobs": 1, **changes}
    path = run_campaign(request_for(folder, **changes), Quiet())
    with JournalReader.open(path) as journal:
        return read_results(journal)


def verdicts(results: Results) -> list[Verdict]:
    return [outcome.verdict for result in results.mutants for outcome in result.outcomes]


def test_a_campaign_runs_over_the_simulation_if_the_original_ends_there_as_over_real_ros(
    tmp_path: Path,
) -> None:
    results = campaign(tmp_path)
    said = (
        "The tests ran over a simulation of ROS 2; the original ends there as over real ROS 2 "
        "(1 test compared)."
    )
    assert results.meta["simulation"] == "ros2"
    assert said in [section.title for section in sections(results, str)]
    assert verdicts(results) == [Verdict.KILLED]
    assert results.verification is not None
    assert (results.verification.checked, results.verification.agreed) == (1, 1)
    assert "Verified: 1 of 1 outcomes end the same over the real middleware." in [
        section.title for section in sections(results, str)
    ]


@pytest.mark.whole
def test_a_mutant_of_it_is_replayed_over_the_simulation(tmp_path: Path) -> None:
    results = campaign(tmp_path)
    request = request_again(tmp_path, results, 1)
    assert request.simulation == "ros2"
    with JournalReader.open(tmp_path / ".mutabot" / "journal.sqlite") as journal:
        (again,) = replay_one(request, journal, results.mutants[0].mutant, [0], Quiet())
    assert again.agrees


@pytest.mark.parametrize(
    ("check", "value", "why"),
    [
        pytest.param(
            "from concurrent.futures import ProcessPoolExecutor; ProcessPoolExecutor(); " + CHECK,
            "0.5",
            "a ProcessPoolExecutor runs on processors of its own.",
            id="not simulated",
        ),
        pytest.param(
            "assert not ros_in_process.is_running(); " + CHECK,
            "0.5",
            "1 test fails on the unmutated program in round 1: tests/test_mission.py::test_it_shows",
            id="another outcome",
            marks=pytest.mark.whole,
        ),
        pytest.param(
            "assert len(heard(mission.run)) == 1",
            '0.25 if __import__("ros_in_process").is_running() else 0.5',
            "tests/test_mission.py::test_it_shows_the_speed differs in round 1 in the simulation: ",
            id="another value",
            marks=pytest.mark.whole,
        ),
    ],
)
def test_else_it_runs_over_real_ros_and_says_why(tmp_path: Path, check: str, value: str, why: str) -> None:
    results = campaign(tmp_path, check, value)
    assert not results.meta["simulation"]
    said = str(results.meta["ran_over"])
    assert said.startswith(f"The tests ran over real ROS 2, not over a simulation of ROS 2: {why}"), said
    assert results.verification is None
    assert verdicts(results) != []


@pytest.mark.whole
@pytest.mark.parametrize("where", ["conftest", "test"])
def test_tests_that_import_launch_run_over_real_ros_with_the_reason(tmp_path: Path, where: str) -> None:
    installed = tmp_path / "site-packages"
    installed.mkdir()
    (installed / "launch.py").write_text("")  # wheels of ROS 2 have none
    code = f"import sys; sys.path.insert(0, {str(installed)!r}); import launch"
    if where == "conftest":
        (tmp_path / "conftest.py").write_text(code)
        code = "pass"
    results = campaign(tmp_path, f"{code}; {CHECK}")
    assert not results.meta["simulation"]
    assert "the package launch starts nodes outside this process" in str(results.meta["ran_over"])
    assert verdicts(results) == [Verdict.KILLED]


@pytest.mark.whole
def test_the_configuration_can_say_real_ros(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION.format(value="0.5"), TESTS.format(check=CHECK), vocabulary=VOCABULARY)
    request = request_for(tmp_path, rounds=1, only=("*reverse*",))
    changed = load_configuration(tmp_path, overrides=("ros.simulation=never",))
    path = run_campaign(replace(request, configuration=changed), Quiet())
    with JournalReader.open(path) as journal:
        results = read_results(journal)
    assert 'the configuration says simulation = "never".' in str(results.meta["ran_over"])
    assert verdicts(results) == [Verdict.KILLED]


@pytest.mark.whole
def test_what_ends_otherwise_over_real_ros_ends_so(tmp_path: Path) -> None:
    results = campaign(tmp_path, "assert heard(mission.run) == [0.5] or not ros_in_process.is_running()")
    assert verdicts(results) == [Verdict.SURVIVED]
    assert results.verification is not None
    (disagreement,) = results.verification.disagreements
    assert disagreement.first.startswith("killed")
    assert disagreement.second.startswith("survived")
    decision = decide(results)
    assert decision.exit_code == 4


def test_nothing_is_verified_if_nobody_wants_it(tmp_path: Path) -> None:
    results = campaign(tmp_path, verify=0)
    assert results.meta["simulation"] == "ros2"
    assert results.verification is None


@pytest.mark.whole
def test_an_explicit_engine_means_real_ros(tmp_path: Path) -> None:
    results = campaign(tmp_path, engine="replay")
    assert not results.meta["ran_over"]
    assert outcomes(tmp_path / ".mutabot" / "journal.sqlite")[0].engine == "replay"


RACE = """
    import time
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from std_msgs.msg import Float64
    import mission

    def test_the_speed_is_heard():
        contexts = [rclpy.Context(), rclpy.Context()]
        for context in contexts:
            rclpy.init(context=context)
        speaker, listener = (rclpy.create_node("node", context=context) for context in contexts)
        executor = SingleThreadedExecutor(context=contexts[1])
        executor.add_node(listener)
        heard = []
        listener.create_subscription(Float64, "/speed", lambda one: heard.append(one.data), 10)
        publisher = speaker.create_publisher(Float64, "/speed", 10)
        until = time.monotonic() + {patience}
        while time.monotonic() < until and not ({is_real} and publisher.get_subscription_count()):
            time.sleep(0.01)
        mission.run(publisher)
        executor.spin_once(2.0)
        for context in contexts:
            context.shutdown()
        assert heard == [0.5]
"""


@pytest.mark.whole
def test_an_order_in_which_the_original_fails_is_reported_with_what_repeats_it(tmp_path: Path) -> None:
    is_real = 'not __import__("ros_in_process").is_running()'
    tests = RACE.format(is_real=is_real, patience=f"(10.0 if {is_real} else 0.1)")
    settings = f'{CONFIGURATION}\nunstable_limit = 1.0\n[ros]\nschedule = "random"\n'
    write_project(tmp_path, MISSION.format(value="0.5"), tests, vocabulary=VOCABULARY, configuration=settings)
    path = run_campaign(request_for(tmp_path, rounds=6, only=("*reverse*",), jobs=1, verify=0), Quiet())
    with JournalReader.open(path) as journal:
        results = read_results(journal)
    assert results.meta["simulation"] == "ros2", results.meta["ran_over"]
    (told, *_) = results.flaky.tests
    assert "fails on the unmutated program with seed" in told
    command = told.rpartition(" repeat it by ")[2].partition(" ")[2]
    assert command.startswith("pytest -p mutabot_ros.simulation.plugin --ros-schedule random")

    def end(round: int) -> int:
        return subprocess.run(
            [sys.executable, "-m", *shlex.split(command)], cwd=tmp_path, check=False,
            env={**os.environ, "MUTABOT_ROUND": str(round)}, capture_output=True,
        ).returncode  # fmt: skip

    failing = {int(re.search(r"in round (\d+)", line)[1]) for line in results.flaky.tests}
    assert {round for round in range(1, 7) if end(round)} == failing
