"""ROS 2 in one process: each file of cases runs over the simulation, in a process of its own."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

import pages

pytestmark = pytest.mark.skipif(
    find_spec("rclpy") is None or find_spec("greenlet") is None,
    reason="no ROS 2 with greenlet: pip install -r requirements-ros2.lock",
)

HERE = Path(__file__).parent
PAGE = pages.ROOT / "docs" / "ros-in-process.md"


def simulated(
    folder: Path, *arguments: str, plugin: str = "ros_in_process.plugin", **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run pytest over the simulation."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", plugin, *arguments]
    return subprocess.run(
        command,
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


def test_every_name_that_the_real_extension_exports_is_there() -> None:
    code = """
import sys, rclpy._rclpy_pybind11 as real
del sys.modules["rclpy._rclpy_pybind11"]
from ros_in_process.middleware.extension import build
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
from ros_in_process.middleware import extension
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
        "from ros_in_process.middleware import executors\nexecutors.KNOWN = 'no text'\n"
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
    assert ours.count("waits by ros_in_process.middleware.executors\n") == 1
    assert rclpys.count("waits by rclpy.executors\n") == 1
    assert ours.count("\n") > 300
    assert ours.replace("ros_in_process.middleware.executors", "rclpy.executors") == rclpys


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


PLUGIN_ALONE = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}


def test_the_example_of_the_page_holds_without_mutabot(tmp_path: Path) -> None:
    (example,) = (block.text for block in pages.blocks(PAGE.read_text()) if block.language == "python")
    (tmp_path / "conftest.py").write_text(
        "import sys\n\n"
        "def pytest_unconfigure():\n"
        "    print('mutabot:', [name for name in sys.modules if 'mutabot' in name])\n"
    )
    (tmp_path / "test_minutes.py").write_text(example)
    done = simulated(tmp_path, **PLUGIN_ALONE)
    assert "1 passed" in done.stdout, done.stdout + done.stderr
    assert "mutabot: []" in done.stdout


def test_time_advances_for_threads_of_nodes(tmp_path: Path) -> None:
    (tmp_path / "test_advance.py").write_text(
        "import threading, time\n"
        "import pytest\n"
        "def test_it(simulated_time):\n"
        "    begin, seen = simulated_time.seconds, []\n"
        "    def look():\n"
        "        for _ in range(3):\n"
        "            time.sleep(10)\n"
        "            seen.append(simulated_time.seconds - begin)\n"
        "    threading.Thread(target=look, daemon=True).start()\n"
        "    simulated_time.advance(25.0)\n"
        "    assert seen == pytest.approx([10, 20], abs=0.01)\n"
        "    with pytest.raises(ValueError, match='does not go back'):\n"
        "        simulated_time.advance(-1.0)\n"
    )
    done = simulated(tmp_path, **PLUGIN_ALONE)
    assert "1 passed" in done.stdout, done.stdout + done.stderr


def test_a_conftest_may_name_the_plug_in(tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text('pytest_plugins = ["ros_in_process.plugin"]\n')
    (tmp_path / "test_it.py").write_text(
        "import time\n\ndef test_an_hour_takes_no_time():\n    time.sleep(3000.0)\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"], cwd=tmp_path,
        env={**os.environ, **PLUGIN_ALONE}, capture_output=True, text=True, timeout=100, check=False,
    )  # fmt: skip
    assert "1 passed" in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize("options", [(), ("--ros-strict",)])
def test_a_strict_run_fails_where_the_program_catches_what_is_not_simulated(
    tmp_path: Path, options: tuple[str, ...]
) -> None:
    (tmp_path / "test_pool.py").write_text(
        "import multiprocessing\n\ndef test_it():\n"
        "    try:\n        multiprocessing.Pool(1)\n    except RuntimeError:\n        pass\n"
    )
    done = simulated(tmp_path, *options, **PLUGIN_ALONE)
    assert ("1 failed" if options else "1 passed") in done.stdout, done.stdout + done.stderr
    assert "needs real ROS: multiprocessing.Pool is not simulated" in done.stdout
