"""The fork engine agrees with replay on all kinds of tests, falls back where it must, leaves nothing."""

from __future__ import annotations

import os
from pathlib import Path
from textwrap import indent
from typing import Any

import pytest

from mutabot.campaign.checking import check
from mutabot.campaign.run import run_campaign
from mutabot.execution.task import Result
from mutabot.model import Outcome, Verdict
from mutabot.model.events import Event, TestStart
from tests.campaign.project import CONFIGURATION, ROBOT, Quiet, outcomes, request_for, write_project
from tests.campaign.scripted import CHECKED, Died, Script

MISSION = """
    def approach(arm):
        arm.move_by(0.25)

    def back_off(arm):
        arm.move_by(-0.125)

    def look(arm):
        return arm.position()

    def run(arm):
        approach(arm)
        back_off(arm)
        return look(arm)
"""
FACTS = (
    "verdict", "by", "test", "message", "exception", "place", "hits", "acted", "example",
    "indistinguishable", "distance", "divergence", "gaps", "compared", "simulated",
)  # fmt: skip


def facts(outcome: Outcome) -> dict[str, object]:
    """Everything about an outcome but what it cost."""
    return {name: getattr(outcome, name) for name in FACTS}


def both_engines(folder: Path, **changes: Any) -> dict[tuple[str, int], Outcome]:
    """Outcomes of the fork engine, after comparing each with replay's."""
    found = {}
    for engine in ("auto", "replay"):
        path = run_campaign(request_for(folder, engine=engine, **changes), Quiet())
        found[engine] = {(outcome.mutant, outcome.round): outcome for outcome in outcomes(path)}
    assert found["auto"].keys() == found["replay"].keys()
    for key, outcome in found["auto"].items():
        assert facts(outcome) == facts(found["replay"][key]), key
    assert {outcome.engine for outcome in found["auto"].values()} <= {"fork", "replay"}
    return found["auto"]


SUITES = {
    "fixtures of every scope": """
        import mission
        import pytest
        from robot import Arm

        TORN_DOWN = []

        @pytest.fixture(scope="session")
        def cell():
            yield "cell"
            TORN_DOWN.append("cell")

        @pytest.fixture(scope="module")
        def station(cell):
            yield "station"
            TORN_DOWN.append("station")

        @pytest.fixture(scope="class")
        def shift(station):
            yield "shift"
            TORN_DOWN.append("shift")

        @pytest.fixture
        def arm(shift):
            arm = Arm()
            yield arm
            assert arm.x < 0.2, "left standing in the way"

        class TestMission:
            def test_approach(self, arm):
                assert "cell" not in TORN_DOWN
                mission.run(arm)

            def test_look(self, arm):
                assert "cell" not in TORN_DOWN
                assert mission.look(arm) == 0

        def test_after_the_class(arm):
            assert "cell" not in TORN_DOWN
            mission.back_off(arm)
            assert arm.x == -0.125
    """,
    "parametrised": """
        import mission
        import pytest
        from robot import Arm

        @pytest.mark.parametrize("start", [0.0, 0.125])
        @pytest.mark.parametrize("times", [1, 2])
        def test_moves(start, times):
            arm = Arm(start)
            for _ in range(times):
                mission.run(arm)
            assert arm.x == start + times * 0.125
    """,
    "unittest": """
        import unittest

        import mission
        from robot import Arm

        class MissionTest(unittest.TestCase):
            @classmethod
            def setUpClass(cls):
                cls.arms = []

            def setUp(self):
                self.arm = Arm()
                self.arms.append(self.arm)

            def tearDown(self):
                self.assertLess(self.arm.x, 0.2)

            def test_run(self):
                self.assertEqual(mission.run(self.arm), 0.125)

            def test_twice(self):
                mission.run(self.arm)
                with self.subTest("again"):
                    mission.back_off(self.arm)
                self.assertEqual(self.arm.x, 0.0)
    """,
    "captured output": """
        import os
        import sys

        import mission
        from robot import Arm

        def test_prints(capsys):
            print("before")
            mission.run(Arm())
            print("after", file=sys.stderr)
            out, err = capsys.readouterr()
            assert (out, err) == ("before\\n", "after\\n")

        def test_writes_to_descriptors(capfd):
            os.write(1, b"before")
            mission.run(Arm())
            os.write(1, b"after")
            assert capfd.readouterr().out == "beforeafter"

        def test_logs(caplog, tmp_path):
            import logging
            logging.warning("here")
            mission.run(Arm())
            assert caplog.messages == ["here"]
    """,
    "random numbers": """
        import random

        import mission
        from robot import Arm

        def test_random_start(mutabot_seed):
            arm = Arm(random.uniform(-0.3, 0.3))
            mission.approach(arm)
            again = random.uniform(-0.3, 0.3)
            mission.back_off(arm)
            assert mission.look(arm) <= 0.45, f"{arm.x} {again} {mutabot_seed}"
    """,
    "loops and generators": """
        import mission
        from robot import Arm

        def steps(arm):
            for _ in range(4):
                yield mission.look(arm)
                mission.back_off(arm)

        def test_goes_down():
            arm = Arm(0.75)
            seen = list(steps(arm))
            assert seen == sorted(seen, reverse=True)
            assert arm.x == 0.25
    """,
}


WHOLE = pytest.mark.whole


@pytest.mark.parametrize(
    "suite", [pytest.param(name, marks=() if name == "parametrised" else WHOLE) for name in SUITES]
)
def test_both_engines_agree(tmp_path: Path, suite: str) -> None:
    write_project(tmp_path, MISSION, SUITES[suite])
    found = [
        outcome for outcome in both_engines(tmp_path).values() if outcome.verdict is not Verdict.NOT_COVERED
    ]
    assert {outcome.engine for outcome in found} == {"fork"}
    assert {outcome.verdict for outcome in found} & {Verdict.KILLED, Verdict.SURVIVED}


@WHOLE
def test_settings_of_the_users_own_do_not_disturb(tmp_path: Path) -> None:
    more = {
        "pytest.ini": "[pytest]\naddopts = -x -s -v --strict-markers\nfilterwarnings = error\n",
        "tests/conftest.py": """
            import pytest

            @pytest.hookimpl(wrapper=True)
            def pytest_runtest_call(item):
                print("calling", item.name)
                return (yield)

            @pytest.fixture(autouse=True)
            def always():
                print("set up")
                yield
                print("taken down")
        """,
    }
    tests = SUITES["parametrised"].replace(
        '@pytest.mark.parametrize("times"', '@pytest.mark.parametrize("times"'
    )
    write_project(tmp_path, MISSION, tests, more=more)
    assert len(both_engines(tmp_path)) > 5


#: what makes it unsafe to fork, as it is told, and what the test does before and after its mission
UNSAFE = {
    "1 more thread": (
        "thread = threading.Thread(target=time.sleep, args=(0.4,)); thread.start()",
        "thread.join()",
    ),
    "subprocess in flight": ("child = subprocess.Popen(['sleep', '0.5'])", "child.wait()"),
    "open socket": ("ends = socket.socketpair()", "[end.close() for end in ends]"),
    "open for reading and writing": (
        "store = sqlite3.connect('parts.db'); store.execute('create table parts (x real)')",
        "store.close()",
    ),
}


@WHOLE
@pytest.mark.parametrize("reasons", [tuple(UNSAFE)], ids=["all"])
def test_where_forking_is_unsafe_the_test_falls_back_to_replay(
    tmp_path: Path, reasons: tuple[str, ...]
) -> None:
    mission = ["def safe(arm):\n    arm.move_by(-0.125)\n"]
    tests = ["import socket, sqlite3, subprocess, threading, time, mission\nfrom robot import Arm\n"]
    tests.append("def test_safe():\n    mission.safe(Arm())\n")
    for number, (before, after) in enumerate(UNSAFE[reason] for reason in reasons):
        mission.append(f"def unsafe_{number}(arm):\n    arm.move_by(0.25)\n")
        lines = [before, f"mission.unsafe_{number}(Arm())", after]
        tests.append(f"def test_unsafe_{number}():\n{indent(chr(10).join(lines), '    ')}\n")
    write_project(tmp_path, "\n".join(mission), "\n".join(tests))
    progress = Quiet()
    request = request_for(tmp_path, engine="auto", only=("*:reverse",))
    engines = {
        outcome.mutant.split(":")[1]: outcome.engine for outcome in outcomes(run_campaign(request, progress))
    }
    assert engines == {"safe": "fork", **{f"unsafe_{number}": "replay" for number in range(len(reasons))}}
    told = dict(enumerate(reasons))
    for number, reason in told.items():
        assert any(f"test_unsafe_{number}" in line and reason in line for line in progress.lines)
    # the controls of a check try one place
    for line in (line for line in check(request, Quiet()).lines if line.startswith("replay")):
        number = int(line.partition("test_unsafe_")[2][0])
        assert told[number] in line


def test_asked_for_forks_alone_an_unsafe_test_is_an_error_and_no_kill(tmp_path: Path) -> None:
    tests = """
        import subprocess
        import mission
        from robot import Arm

        def test_unsafe():
            child = subprocess.Popen(["sleep", "0.5"])
            mission.approach(Arm())
            child.wait()
    """
    write_project(tmp_path, MISSION, tests)
    path = run_campaign(request_for(tmp_path, engine="fork"), Quiet())
    assert {outcome.verdict for outcome in outcomes(path)} == {Verdict.ERROR}


TWO_TESTS = """
    import mission
    from robot import Arm

    def test_a():
        mission.back_off(Arm())

    def test_b():
        mission.approach(Arm())
        mission.look(Arm())
"""


def test_a_fork_parent_that_dies_leaves_its_mutants_to_replay(tmp_path: Path, script: Script) -> None:
    # the baseline is the first run, the fork parent the second
    script.original = lambda run: Died(3) if run.test.endswith("test_b") and run.before == 1 else {}
    # before the fork parent dies; what survives has not come to the end of the session
    script.kill(":back_off:")
    write_project(tmp_path, MISSION, TWO_TESTS)
    progress = Quiet()
    path = run_campaign(request_for(tmp_path, engine="auto"), progress)
    found = {outcome.mutant.split(":")[1]: outcome for outcome in outcomes(path)}
    assert any(
        "fork parent of round 1 died: the process ended with exit code 3" in line for line in progress.lines
    )
    assert {name: outcome.engine for name, outcome in found.items()} == {
        "back_off": "fork", "approach": "replay", "look": "replay",
    }  # fmt: skip
    assert Verdict.ERROR not in {outcome.verdict for outcome in found.values()}


def test_a_test_that_fails_in_the_fork_parent_judges_no_mutant(tmp_path: Path, script: Script) -> None:
    script.original = lambda run: CHECKED if run.test.endswith("test_b") and run.before else {}
    script.mutated = lambda run: CHECKED
    write_project(tmp_path, MISSION, TWO_TESTS)
    path = run_campaign(request_for(tmp_path, engine="auto"), Quiet())
    verdicts = {outcome.mutant.split(":")[1]: outcome.verdict for outcome in outcomes(path)}
    assert verdicts == {
        "approach": Verdict.UNSTABLE, "look": Verdict.UNSTABLE, "back_off": Verdict.KILLED,
    }  # fmt: skip


BUSY = """
    import os
    import pathlib
    import time

    import mission
    from robot import Arm

    FOLDER = pathlib.Path("{folder}")

    def test_busy():
        arm = Arm()
        mission.run(arm)
        mark = FOLDER / str(os.getpid())
        mark.touch()
        running = len(list(FOLDER.iterdir()))
        end = time.monotonic() + 0.05
        while time.monotonic() < end:
            running = max(running, len(list(FOLDER.iterdir())))
        mark.unlink()
        assert running <= 2, f"{{running}} at once"
        assert arm.x == 0.125
"""


def test_never_more_processes_compute_than_asked_for(tmp_path: Path, common: Path) -> None:
    busy = BUSY.format(folder=common)
    write_project(tmp_path, MISSION, busy, configuration=CONFIGURATION + "    rounds = 3\n")
    path = run_campaign(request_for(tmp_path, engine="fork", jobs=2), Quiet())
    found = outcomes(path)
    assert len(found) > 20
    assert not [outcome for outcome in found if "at once" in (outcome.message or "")]


def children() -> set[str]:
    with open(f"/proc/self/task/{os.getpid()}/children", encoding="ascii") as file:  # noqa: PTH123
        return set(file.read().split())


def test_nothing_is_left_running_or_open_or_on_disk(tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, SUITES["parametrised"], robot=ROBOT)
    run_campaign(request_for(tmp_path, engine="fork"), Quiet())
    descriptors, before = set(Path("/proc/self/fd").iterdir()), children()
    run_campaign(request_for(tmp_path, engine="fork"), Quiet())
    assert set(Path("/proc/self/fd").iterdir()) == descriptors
    assert children() == before
    assert not [path for path in (tmp_path / ".mutabot").iterdir() if path.name.startswith("work-")]


def test_the_test_that_a_fork_begins_is_not_taken_for_its_parent_s(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    take = Result.take

    def noted(self: Result, event: Event) -> None:
        if isinstance(event, TestStart) and self.task.is_fork_parent:
            told.append(event.test.rpartition("::")[2])
        take(self, event)

    monkeypatch.setattr(Result, "take", noted)
    write_project(
        tmp_path,
        "def run(arm):\n    arm.move_by(0.25)\n",
        """
        import mission
        from robot import Arm

        def test_first():
            mission.run(Arm())

        def test_second():
            mission.run(Arm())
        """,
    )
    found = outcomes(run_campaign(request_for(tmp_path, engine="fork", only=("reverse",)), Quiet()))
    assert {(outcome.verdict, outcome.engine, outcome.tests) for outcome in found} == {
        (Verdict.SURVIVED, "fork", 2)
    }
    assert told == ["test_first", "test_second"]


def test_processes_of_a_campaign_remember_together(tmp_path: Path) -> None:
    """The test looks closely only where another process, which is the baseline, has run it before."""
    write_project(
        tmp_path,
        "def run(arm):\n    arm.move_by(0.25)\n",
        """
        import mission
        from mutabot.api.processes import SharedMemory
        from robot import Arm

        def test_once():
            memory, key = SharedMemory.current(), b"test_once".ljust(SharedMemory.key_size)
            is_first = memory.get(key) is None
            memory.put(key, b"was here")
            arm = Arm()
            mission.run(arm)
            assert is_first or arm.x == 0.25
        """,
    )
    found = outcomes(run_campaign(request_for(tmp_path, engine="fork", only=("reverse",)), Quiet()))
    assert {(outcome.verdict, outcome.by, outcome.engine) for outcome in found} == {
        (Verdict.KILLED, "check", "fork")
    }


@pytest.mark.parametrize("stream", ["mock.Mock()", "None", "closed()"])
def test_forks_leave_alone_what_a_test_writes_to(tmp_path: Path, stream: str) -> None:
    write_project(
        tmp_path,
        "def run(arm):\n    arm.move_by(0.25)\n",
        f"""
        import io
        import sys
        from unittest import mock

        import mission
        from robot import Arm

        def closed():
            stream = io.TextIOWrapper(io.BytesIO())
            stream.close()
            return stream

        def test_runs():
            arm = Arm()
            with mock.patch("sys.stdout", {stream}) as out, mock.patch("sys.stderr", {stream}):
                mission.run(arm)
                calls = getattr(out, "mock_calls", [])
            assert arm.x == 0.25
            assert calls == []
        """,
    )
    found = outcomes(run_campaign(request_for(tmp_path, engine="fork", only=("skip",)), Quiet()))
    assert [(outcome.verdict, outcome.engine) for outcome in found] == [(Verdict.KILLED, "fork")]
