"""A campaign on a cluster comes to the same outcomes as one without, whatever happens to its workers."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.request import Request
from mutabot.campaign.run import run_campaign
from mutabot.errors import UsageError
from mutabot.execution.workers import Workers
from mutabot.model import Verdict
from mutabot_dask import connection
from mutabot_dask.link import Link
from mutabot_dask.settings import ClusterSettings
from tests.campaign.project import Quiet, outcomes, request_for

from .clusters import Ends, cluster, ends, kill, on_cluster, processes, run_twice, until, write, write_slow

#: marks the processes of this module's own clusters
MARK = f"OF_TEST_CLUSTER={os.getpid()}"


@pytest.fixture(scope="module")
def there(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClusterSettings]:
    """A cluster of two workers."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(*MARK.split("="))
        patch.setenv("PYTHONHASHSEED", "77")  # as nannies set one
        with cluster(tmp_path_factory.mktemp("dask"), 2) as found:
            patch.delenv("PYTHONHASHSEED")
            patch.delenv("OF_TEST_CLUSTER")
            yield found


def slow(folder: Path) -> Request:
    """A campaign that takes a while."""
    return request_for(write_slow(folder), engine="replay", only=("reverse", "skip"))


@pytest.fixture(scope="module")
def in_peace(tmp_path_factory: pytest.TempPathFactory) -> Ends:
    """Outcomes of the project that takes a while, without a cluster."""
    request = slow(tmp_path_factory.mktemp("in_peace"))
    return ends(run_campaign(request, Quiet()))


def has_begun(told: Quiet) -> bool:
    """Whether some mutants have their outcomes."""
    return sum(line.startswith("#") for line in told.lines) > 1


def workers() -> list[int]:
    return processes(MARK.encode(), "multiprocessing.spawn")


def when(condition: Callable[[], bool], then: Callable[[], Any]) -> threading.Thread:
    """Do something as soon as it is time."""
    thread = threading.Thread(target=lambda: until(condition, 300) and then())
    thread.start()
    return thread


@pytest.mark.whole
@pytest.mark.parametrize("engine", ["fork", "replay"])
def test_outcomes_are_those_of_a_campaign_without_a_cluster(
    engine: str, there: ClusterSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    ask = Link.ask
    monkeypatch.setattr(Link, "ask", lambda *given: asked.append(given[2].__name__) or ask(*given))
    project = write(tmp_path / "project")
    only = () if engine == "fork" else ("reverse",)
    plain, found, told = run_twice(project, there, engine=engine, only=only)
    assert found == plain
    assert asked.count("run_unit") >= (2 if engine == "fork" else len(plain)), told.lines
    assert [line.partition(",")[0] for line in told.lines if "worker" in line] == ["workers are sent 5 files"]


@pytest.mark.whole
def test_a_worker_that_dies_costs_nothing_but_time(
    there: ClusterSettings, in_peace: Ends, tmp_path: Path
) -> None:
    request = slow(tmp_path)
    told, victims = Quiet(), workers()
    killer = when(lambda: has_begun(told), lambda: kill(victims))
    path = run_campaign(on_cluster(request, there), told)
    killer.join()
    assert ends(path) == in_peace
    assert victims
    assert not set(victims) & set(workers())


@pytest.mark.whole
def test_a_mutant_that_takes_its_worker_along_each_time_is_an_error_with_the_reason(
    there: ClusterSettings, tmp_path: Path
) -> None:
    tests = """
    import os, signal
    from mission import run
    from robot import Arm

    def test_run():
        arm = Arm()
        run(arm)
        if arm.x != 0.5 and "OF_TEST_CLUSTER" in os.environ:
            with open(f"/proc/{os.getppid()}/stat") as file:  # of the supervisor, whose parent is the worker
                os.kill(int(file.read().rpartition(")")[2].split()[1]), signal.SIGKILL)
    """
    project = write(tmp_path / "project", mission="def run(arm):\n    arm.move_by(0.5)\n", tests=tests)
    request = request_for(project, engine="replay", only=("reverse",))
    (found,) = outcomes(run_campaign(on_cluster(request, there), Quiet()))
    assert found.verdict is Verdict.ERROR
    assert found.message is not None
    assert found.message.startswith("4 workers could not run it: its worker was lost")
    assert until(lambda: len(workers()) == 2)


@pytest.mark.whole
def test_a_process_that_is_killed_from_outside_each_time_is_an_error(
    there: ClusterSettings, tmp_path: Path
) -> None:
    tests = """
    import os, signal
    from mission import run
    from robot import Arm

    def test_run():
        arm = Arm()
        run(arm)
        if arm.x != 0.5:
            os.kill(os.getpid(), signal.SIGKILL)
    """
    project = write(tmp_path / "project", mission="def run(arm):\n    arm.move_by(0.5)\n", tests=tests)
    plain, found, _ = run_twice(project, there, engine="replay", only=("reverse",))
    assert found == plain
    assert Verdict.ERROR in {end["verdict"] for end in found.values()}


@pytest.mark.whole
def test_a_machine_on_which_tests_fail_without_any_mutant_kills_nothing(
    there: ClusterSettings, tmp_path: Path
) -> None:
    tests = """
    import os
    from mission import run
    from robot import Arm

    def test_run():
        arm = Arm()
        run(arm)
        assert "OF_TEST_CLUSTER" not in os.environ, "no licence on this machine"
        assert arm.x < 0.9
    """
    project = write(tmp_path / "project", mission="def run(arm):\n    arm.move_by(0.5)\n", tests=tests)
    plain, found, told = run_twice(project, there, engine="replay", only=("reverse",))
    assert found == plain
    assert "error" not in {end["verdict"] for end in found.values()}
    text = "\n".join(told.lines)
    assert "fails there without any mutant: " in text
    assert "no licence on this machine" in text
    assert "the campaign goes on on this machine" in text


@pytest.mark.whole
@pytest.mark.parametrize("engine", ["replay", pytest.param("fork", marks=pytest.mark.whole)])
def test_what_takes_too_long_on_a_worker_is_decided_at_home(
    engine: str, there: ClusterSettings, tmp_path: Path
) -> None:
    tests = """
    import os, time
    from mission import run
    from robot import Arm

    def test_run():
        arm = Arm()
        run(arm)
        if arm.x != 0.5 and "OF_TEST_CLUSTER" in os.environ:
            time.sleep(60)
    """
    settings = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-o", "pythonpath=."]
    timeout_seconds = 2.0
    """
    project = write(
        tmp_path / "project",
        mission="def run(arm):\n    arm.move_by(0.5)\n",
        tests=tests,
        configuration=settings,
    )
    request = request_for(project, engine=engine, only=("reverse",))
    (found,) = outcomes(run_campaign(on_cluster(request, there), Quiet()))
    assert (found.verdict, found.engine) == (Verdict.SURVIVED, engine), found.message


def test_a_worker_that_runs_with_something_else_is_refused(
    there: ClusterSettings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = {**Workers.versions(), "numpy": "0.0.1"}
    monkeypatch.setattr(Workers, "versions", lambda: here)
    project = write(tmp_path / "project", mission="def run(arm):\n    arm.move_by(0.5)\n", tests="""
    from mission import run
    from robot import Arm

    def test_run():
        run(Arm())
    """)  # fmt: skip
    request = request_for(project, engine="replay", only=("reverse",))
    with pytest.raises(UsageError, match=r"it runs with something else: numpy is \S+ there, 0\.0\.1 here"):
        run_campaign(on_cluster(request, there), Quiet())


@pytest.mark.whole
def test_a_scheduler_that_is_killed_is_started_again(
    in_peace: Ends, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OF_TEST_SCHEDULER", str(tmp_path))
    mark = f"OF_TEST_SCHEDULER={tmp_path}".encode()
    told = Quiet()
    killer = when(lambda: has_begun(told), lambda: kill(processes(mark, "dask_scheduler")))
    path = run_campaign(on_cluster(slow(tmp_path), "local:1"), told)
    killer.join()
    assert ends(path) == in_peace
    assert sum("is gone; outcomes so far are kept" in line for line in told.lines) == 1
    assert until(lambda: not processes(mark))


@pytest.mark.whole
def test_a_scheduler_that_stays_away_leaves_the_rest_to_this_machine(
    in_peace: Ends, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connection, "_RETURN", 1.0)
    request = slow(tmp_path / "project")
    before = set(_below(os.getpid()))
    with cluster(tmp_path / "dask", 1) as there, pytest.MonkeyPatch.context() as patch:
        told = Quiet()
        patch.setattr("mutabot_dask.link.PATIENCE", 1.0)
        own = [pid for pid in _below(os.getpid()) if pid not in before and "dask_scheduler" in _command(pid)]
        killer = when(lambda: has_begun(told), lambda: kill(own))
        path = run_campaign(on_cluster(request, there), told)
        killer.join()
    assert ends(path) == in_peace
    assert sum("the campaign goes on on this machine" in line for line in told.lines) == 1


def _below(parent: int) -> list[int]:
    found = []
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            try:
                if int((folder / "stat").read_text().rpartition(")")[2].split()[1]) == parent:
                    found.append(int(folder.name))
            except OSError:
                continue
    return sorted(found)


def _command(pid: int) -> str:
    return Path(f"/proc/{pid}/cmdline").read_bytes().decode("utf-8", "replace")


@pytest.mark.whole
@pytest.mark.parametrize(("count", "engine"), [(1, "auto"), (8, "replay")])
def test_outcomes_are_the_same_on_any_number_of_workers(count: int, engine: str, tmp_path: Path) -> None:
    plain, found, _ = run_twice(write(tmp_path), f"local:{count}", engine=engine)
    assert found == plain


@pytest.mark.whole
def test_a_worker_that_hangs_is_replaced(
    in_peace: Ends, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL", "4s")
    monkeypatch.setenv("OF_TEST_SCHEDULER", str(tmp_path))
    mark = f"OF_TEST_SCHEDULER={tmp_path}".encode()
    request = slow(tmp_path)
    told = Quiet()
    stopper = when(
        lambda: has_begun(told),
        lambda: kill(processes(mark, "multiprocessing.spawn")[:1], signal.SIGSTOP),
    )
    path = run_campaign(on_cluster(request, "local:2"), told)
    stopper.join()
    assert ends(path) == in_peace
    assert until(lambda: not processes(mark))
