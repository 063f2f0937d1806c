"""ROS 2 in one process: each file of cases runs over the simulation, in a process of its own."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from campaign.project import run, write_project
from mutabot.model import Verdict
from packages.ros.test_ros2_example import EXPECTED

pytestmark = pytest.mark.skipif(
    find_spec("rclpy") is None or find_spec("greenlet") is None,
    reason="no ROS 2 with greenlet: pip install -r requirements-ros2.lock",
)

HERE = Path(__file__).parent
ROOT = Path(__file__).parents[4]
EXAMPLE = ROOT / "examples" / "ros2"


def simulated(folder: Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run pytest over the simulation."""
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "-p",
        "mutabot_ros.simulation.plugin",
    ]
    return subprocess.run(
        [*command, *arguments],
        cwd=folder,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1", **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.mark.parametrize(
    "cases", ["time_cases.py", "process_cases.py", "middleware_cases.py", "fork_cases.py"]
)
def test_every_case_holds(cases: str) -> None:
    done = simulated(HERE, "-c", os.devnull, f"--rootdir={HERE}", cases)
    assert done.returncode == 0, done.stdout + done.stderr


def test_what_nodes_do_is_seen_and_mutated_as_over_real_ros() -> None:
    done = simulated(
        ROOT, "-W", "default", "tests/packages/ros/ros2_cases.py", PYTEST_DISABLE_PLUGIN_AUTOLOAD="1"
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_name_that_the_real_extension_exports_is_there() -> None:
    code = """
import sys, rclpy._rclpy_pybind11 as real
del sys.modules["rclpy._rclpy_pybind11"]
from mutabot_ros.simulation.middleware.extension import build
ours = build()
names = [name for name in dir(real) if not name.startswith("__")]
print([name for name in names if not hasattr(ours, name)])
for kind in set(names) - {"EventsExecutor"}:
    for name, member in vars(getattr(real, kind)).items() if isinstance(getattr(real, kind), type) else ():
        if not name.startswith("_") and not isinstance(member, property):
            if not hasattr(getattr(ours, kind), name):
                print(kind, name)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stdout == "[]\n", done.stdout + done.stderr


def test_a_release_of_rclpy_that_uses_other_names_needs_real_ros() -> None:
    code = """
from mutabot_ros.simulation.middleware import extension
build = extension.build
def older():
    module = build()
    del module.WaitSet, module.rclpy_serialize
    return module
extension.build = older
extension.install()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    said = "needs real ROS: this release of rclpy uses what is not simulated: WaitSet, rclpy_serialize"
    assert said in done.stderr


def test_rclpy_must_not_be_there_already(tmp_path: Path) -> None:
    (tmp_path / "early.py").write_text("import rclpy")
    done = simulated(tmp_path, "-p", "early", PYTHONPATH=os.pathsep.join([str(tmp_path), *sys.path]))
    assert "ERROR: needs real ROS: rclpy was imported before the simulation was set up" in done.stderr


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
        done = simulated(folder, MUTABOT_SEED=seed)
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
            pytest.param(*one, marks=pytest.mark.whole)
            for one in (("RuntimeError", False), ("()", False), ("()", True))
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


def test_runs_are_equal_whatever_the_hash_seed() -> None:
    logs = set()
    for seed in ("0", "1", "77"):
        done = simulated(
            HERE, "-s", "-c", os.devnull, f"--rootdir={HERE}", "logged_cases.py", PYTHONHASHSEED=seed
        )
        logs.add(done.stdout.partition("warnings summary")[0])
    assert len(logs) == 1
    assert next(iter(logs)).count("\n") > 300


def test_executors_do_with_less_work_what_the_known_text_of_rclpy_does(tmp_path: Path) -> None:
    (tmp_path / "rclpys_own.py").write_text(
        "from mutabot_ros.simulation.middleware import executors\nexecutors.KNOWN = 'no text'\n"
    )
    (tmp_path / "told.py").write_text(
        "def pytest_runtest_teardown():\n"
        "    from rclpy.executors import Executor\n"
        "    print('waits by', Executor._wait_for_ready_callbacks.__module__)\n"
    )
    path = os.pathsep.join([str(tmp_path), *sys.path])

    def log(*plugins: str) -> str:
        options = [word for name in ("told", *plugins) for word in ("-p", name)]
        cases = ("-s", "-c", os.devnull, f"--rootdir={HERE}", "logged_cases.py")
        return simulated(HERE, *options, *cases, PYTHONPATH=path).stdout.partition("warnings summary")[0]

    ours, rclpys = log(), log("rclpys_own")
    assert ours.count("waits by mutabot_ros.simulation.middleware.executors\n") == 1
    assert rclpys.count("waits by rclpy.executors\n") == 1
    assert ours.count("\n") > 300
    assert ours.replace("mutabot_ros.simulation.middleware.executors", "rclpy.executors") == rclpys


def test_a_race_is_found_by_random_orders_and_replayed_by_its_seed() -> None:
    def run(*options: str) -> subprocess.CompletedProcess[str]:
        return simulated(HERE, "-c", os.devnull, f"--rootdir={HERE}", "-v", *options)

    assert run("race_cases.py").returncode == 0
    for seed in range(8):
        found = run("race_cases.py", "--ros-schedule=random", f"--ros-seed={seed}")
        if found.returncode:
            break
    assert found.returncode == 1, "no order shows the race"
    order = re.search(r"simulated ROS: (.+)", found.stdout)
    failed = re.search(r"FAILED (\S+) - (.+)", found.stdout)
    assert order is not None
    assert failed is not None
    again = run(failed[1], *shlex.split(order[1]))
    assert again.returncode == 1
    assert failed[0] in again.stdout
