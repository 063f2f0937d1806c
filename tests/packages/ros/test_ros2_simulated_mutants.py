"""mutabot over ROS 2 in one process: its hooks, its mutants and the example are there as over real ROS 2."""

from __future__ import annotations

import shutil
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import pytest

from campaign.project import run, write_project
from mutabot.model import Verdict
from packages.ros.test_ros2_example import EXPECTED
from packages.ros_in_process.test_ros2_in_process import simulated

pytestmark = pytest.mark.skipif(
    find_spec("rclpy") is None or find_spec("greenlet") is None,
    reason="no ROS 2 with greenlet: pip install -r requirements-ros2.lock",
)

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "examples" / "ros2"
simulated_in_campaigns = partial(simulated, plugin="mutabot_ros.simulation.plugin")


def test_what_nodes_do_is_seen_and_mutated_as_over_real_ros() -> None:
    done = simulated_in_campaigns(
        ROOT, "-W", "default", "tests/packages/ros/ros2_cases.py", PYTEST_DISABLE_PLUGIN_AUTOLOAD="1"
    )
    assert done.returncode == 0, done.stdout + done.stderr


def example_over_the_simulation(folder: Path) -> Path:
    """A copy of the example whose suite runs over the simulation."""
    copy = folder / "ros2"
    shutil.copytree(EXAMPLE, copy, ignore=shutil.ignore_patterns(".mutabot", "__pycache__", ".pytest_cache"))
    settings = copy / "pyproject.toml"
    text = settings.read_text()
    plain = 'addopts = ["--strict-markers", "--strict-config"]'
    assert plain in text
    settings.write_text(text.replace(plain, plain[:-1] + ', "-p", "mutabot_ros.simulation.plugin"]'))
    return copy


@pytest.mark.usefixtures("plugins")
def test_the_example_runs_unmodified(tmp_path: Path) -> None:
    folder = tmp_path / "ros2"
    shutil.copytree(
        EXAMPLE, folder, ignore=shutil.ignore_patterns(".mutabot", "__pycache__", ".pytest_cache")
    )
    for seed in ("0", "2"):
        done = simulated_in_campaigns(folder, MUTABOT_SEED=seed)
        assert "1 passed" in done.stdout, done.stdout + done.stderr
        assert "needs real ROS" not in done.stdout


@pytest.mark.usefixtures("plugins")
@pytest.mark.parametrize("engine", ["fork", pytest.param("replay", marks=pytest.mark.whole)])
def test_mutants_end_over_the_simulation_as_over_real_ros(tmp_path: Path, engine: str) -> None:
    folder = example_over_the_simulation(tmp_path)
    found = run(folder, rounds=1, baseline=1, only=tuple(EXPECTED), engine=engine)
    assert {mutant: outcome.verdict for mutant, outcome in found.items()} == EXPECTED, found
    assert {outcome.engine for outcome in found.values()} == {engine}


@pytest.mark.whole
@pytest.mark.usefixtures("plugins")
def test_nodes_in_processes_of_their_own_are_killed_and_begin_anew(tmp_path: Path) -> None:
    folder = example_over_the_simulation(tmp_path)
    expected = {
        "mission.py:run:arm.home#1:call:kill-node": Verdict.KILLED,
        # at home it begins with what it has done already
        "mission.py:run:arm.home#1:call:restart-node": Verdict.SURVIVED,
        # the box is in the gripper, and the second start opens it
        "mission.py:run:arm.home#2:call:restart-node": Verdict.KILLED,
    }
    found = run(folder, rounds=1, baseline=1, families=("middleware",), only=tuple(expected), engine="fork")
    assert {mutant: outcome.verdict for mutant, outcome in found.items()} == expected, found


@pytest.mark.usefixtures("plugins")
@pytest.mark.parametrize(
    ("caught", "in_fixture"),
    [
        ("RuntimeError", True),
        *(
            pytest.param(*parameters, marks=pytest.mark.whole)
            for parameters in (("RuntimeError", False), ("()", False), ("()", True))
        ),
    ],
)
def test_a_mutant_that_meets_what_is_not_simulated_is_an_error_and_no_kill(
    tmp_path: Path, caught: str, in_fixture: bool
) -> None:
    mission = f"""
        import multiprocessing

        def run(arm):
            arm.move_by(0.25)
            if arm.x < 0:
                try:
                    multiprocessing.Pool(1)
                except {caught}:
                    pass
    """
    tests = """
        import mission
        import pytest
        from robot import Arm

        def test_run(ran):
            assert ran or not mission.run(Arm())
    """
    tests += f"""
        @pytest.fixture
        def ran():
            if {in_fixture}:
                mission.run(Arm())
            return {in_fixture}
    """
    plugin = 'pytest_args = ["-o", "pythonpath=.", "-p", "mutabot_ros.simulation.plugin"]'
    settings = f'program = ["mission.py"]\nvocabulary = ["robot.toml"]\n{plugin}\n'
    folder = write_project(tmp_path, mission, tests, configuration=settings)
    for engine in ("fork", "replay"):
        (found,) = run(folder, rounds=1, fresh=True, only=("*:reverse",), engine=engine).values()
        assert found.verdict is Verdict.ERROR
        assert "needs real ROS: multiprocessing.Pool is not simulated" in (found.message or "")
