"""Processes that ``multiprocessing`` starts below a fork are the mutant, as those below a fresh process."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.model import Mutant, Role, Site, Span, Verdict, events
from mutabot.model.events import FORKED, STARTED, TestEnd
from mutabot.model.fold import ChildRecord, FactsOfTest, fold
from mutabot.model.job import Job
from mutabot.model.mutant import Place
from mutabot.model.operation import Vocabulary
from tests.campaign.project import CONFIGURATION, run, write_project

MISSION = """
    import multiprocessing as mp
    import os
    import subprocess
    import sys
    from concurrent.futures import ProcessPoolExecutor
    from unittest import mock

    from robot import Arm

    def put(queue, work):
        queue.put(work(0.25))

    def run(kind, work):
        context = mp.get_context(kind)
        queue = context.SimpleQueue()
        process = context.Process(target=put, args=(queue, work))
        process.start()
        process.join()
        return queue.get()

    def by_posix_spawn(name):
        code = f"import mission, os; os._exit(int(100 * mission.{name}(0.25)) % 256)"
        command = [sys.executable, "-c", code]
        _, status = os.waitpid(os.posix_spawn(sys.executable, command, os.environ), 0)
        return os.waitstatus_to_exitcode(status) / 100

    def with_nothing(name, start):
        code = f"import sys; sys.path[:0] = {sys.path!r}; import mission, os; "
        code += f"os._exit(int(100 * mission.{name}(0.25)) % 256)"
        command = [sys.executable, "-c", code]
        if start == "posix_spawn":
            pid = os.posix_spawn(sys.executable, command, {})
        elif start == "spawn":
            pid = os.spawnve(os.P_NOWAIT, sys.executable, command, {"LANG": "C"})
        elif (pid := os.fork()) == 0:
            os.execve(path=sys.executable, argv=command, env={})
        return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) / 100
"""
#: what runs a function that moves the robot
WAYS = {
    "spawn": "run('spawn', {})",
    "forkserver": "run('forkserver', {})",
    "nested": "run('spawn', {}_below)",
    "executor": "next(ProcessPoolExecutor(1, mp_context=mp.get_context('spawn')).map({}, [0.25]))",
    "posix_spawn": "by_posix_spawn('{}')",
    "empty_spawn": "with_nothing('{}', 'posix_spawn')",
    "spawnve": "with_nothing('{}', 'spawn')",
    "execve": "with_nothing('{}', 'execve')",
}


def project(folder: Path, ways: list[str]) -> Path:
    mission, tests = MISSION, "    import mission\n"
    for way in ways:
        mission += f"""
    def move_{way}(dx):
        arm = Arm()
        arm.move_by(dx)
        return arm.x

    def move_{way}_below(dx):
        return run("spawn", move_{way})

    def {way}():
        return {WAYS[way].format(f"move_{way}")}
"""
        # the mutant is forked, and has acted, before a process is started
        tests += f"\n    def test_here_{way}():\n        mission.move_{way}(0.25)\n"
        tests += f"\n    def test_{way}():\n        assert mission.{way}() == 0.25\n"
    configuration = CONFIGURATION + "    timeout_seconds = 30\n"
    return write_project(folder, mission, tests, configuration=configuration)


@pytest.mark.parametrize("ways", [["spawn", "empty_spawn"], pytest.param([*WAYS], marks=pytest.mark.whole)])
def test_processes_below_a_fork_are_its_mutant(tmp_path: Path, ways: list[str]) -> None:
    found = run(project(tmp_path, ways), engine="auto", only=("reverse",))
    assert {(outcome.verdict, outcome.test) for outcome in found.values()} == {
        (Verdict.KILLED, f"tests/test_mission.py::test_{way}") for way in ways
    }


SITE = Site(Span("m.py", 1, 0, 1, 9, "run"), "arm.move", 1, Role.PROGRAM)
MUTANT = Mutant(1, "robot", "skip", SITE, "robot:Arm.move", None, None, "", "")


@pytest.mark.parametrize(
    ("end", "is_missed"),
    [
        (TestEnd("a::one", "passed", hits=3, acted=3), True),
        (TestEnd("a::one", "passed", hits=3, acted=3, hit_below=(FORKED,)), True),
        (TestEnd("a::one", "passed", hits=3, acted=3, hit_below=(FORKED, STARTED)), False),
        (TestEnd("a::one", "failed", hits=3, acted=3), False),
        (TestEnd("b::two", "passed", hits=1, acted=1), False),
    ],
)
def test_a_fork_whose_processes_did_not_all_get_its_mutant_says_nothing(
    end: TestEnd, is_missed: bool
) -> None:
    baseline = Baseline()
    for origin in (STARTED, FORKED):
        baseline.reach_below(0, Place.of(MUTANT), "a::one", origin)
    assert baseline.is_missed(0, MUTANT, end) == is_missed


def test_the_origin_of_processes_with_calls_and_hits_is_reported() -> None:
    site = events.SiteSeen(0, SITE.span, "robot:Arm.move", None, oracle=False)
    records = []
    for number, (is_forked, hits) in enumerate([(False, 1), (True, 0)]):
        record = ChildRecord(events.Began(number, number, ("python",), 0.0, forked=is_forked))
        for event in (site, events.Called(0, {}, {}, None, 0.0), events.Did("a::one", hits=hits)):
            record.add(event)
        records.append(record)
    job = Job("/", ("m.py",), (), Vocabulary(), 1, 0, record=True)
    end = fold(TestEnd("a::one", "passed"), records, FactsOfTest(job, lambda seen: 7))
    assert end.below == {STARTED: (7,), FORKED: (7,)}
    assert end.hit_below == (STARTED,)
