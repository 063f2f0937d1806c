"""Programs that the tests start as processes: each end has the verdict that a person would give."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.model import Outcome, Verdict
from tests.campaign.outside import killer
from tests.campaign.project import CONFIGURATION, REPLAY, ROBOT, Quiet, request_for, run, write_project

TESTS = """
    import json
    import os
    import subprocess
    import sys

    def start(*arguments):
        command = [sys.executable, "mission.py", *arguments]
        return subprocess.run(command, capture_output=True, text=True, timeout=60)

    def test_mission():
        done = start()
        assert done.returncode == 0, done.stderr
        assert done.stdout == "0.5\\n"
"""


#: one script per fact, each of which a test of its own starts
SCRIPTS = {
    "refused.py": """
        from robot import Arm, Refused

        arm = Arm(x=0.9)
        arm.move_by(-0.4)
        try:
            arm.move_by(0.4)
            arm.move_by(-0.4)
        except Refused:
            print("gave up")
        print(round(arm.x, 6))
    """,
    "crashes.py": """
        import ctypes

        from robot import Arm

        arm = Arm()
        arm.move_by(0.5)
        if arm.x < 0:
            ctypes.string_at(0)
        print(arm.x)
    """,
    "endless.py": """
        from robot import Arm

        arm = Arm()
        arm.move_by(0.5)
        while arm.position() < 0:
            pass
        print(arm.x)
    """,
    "bare.py": """
        from robot import Arm

        arm = Arm()
        arm.move_by(0.5)
        print(arm.x)
    """,
    "spawned.py": """
        from robot import Arm

        arm = Arm()
        arm.move_by(0.5)
        print(arm.x)
    """,
    "stays.py": """
        import time

        from robot import Arm

        arm = Arm()
        arm.move_by(0.5)
        print(arm.x, flush=True)
        if arm.x < 0:
            time.sleep(60)
    """,
}
#: how their tests start them; the last one ends its script by a program
STARTS = """
    import os
    import subprocess
    import sys

    def start(name, **options):
        return subprocess.run([sys.executable, name], capture_output=True, text=True, timeout=60, **options)

    def check(done):
        assert done.returncode == 0, done.stderr
        assert done.stdout == "0.5\\n"

    def test_refused():
        check(start("refused.py"))

    def test_crashes():
        check(start("crashes.py"))

    def test_endless():
        check(start("endless.py"))

    def test_bare():
        check(start("bare.py", env={"PATH": os.environ["PATH"], "PYTHONPATH": "elsewhere"}))

    def test_spawned():  # without files to close, `subprocess` may start it in another way
        check(start("spawned.py", env={"PATH": os.environ["PATH"]}, close_fds=False))

    def test_stays():
        stays = subprocess.Popen([sys.executable, "stays.py"], stdout=subprocess.PIPE, text=True)
        for line in stays.stdout:
            if float(line) < 0:
                subprocess.run(["sh", "-c", f"kill -9 {stays.pid}"], check=True)
        assert stays.wait() == 0
"""


@pytest.fixture(scope="module")
def ends(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Outcome]:
    """How the mutant that reverses the first move of each script ends, by the script."""
    names = ", ".join(f'"{name}"' for name in SCRIPTS)
    # one of them computes until that is up
    configuration = CONFIGURATION.replace('"mission.py"', names) + "    timeout_seconds = 3\n"
    folder = tmp_path_factory.mktemp("scripts")
    write_project(folder, "", STARTS, more=SCRIPTS, configuration=configuration)
    found = run(folder, only=("*arm.move_by#1:dx:reverse",))
    return {mutant.partition(":")[0]: outcome for mutant, outcome in found.items()}


def ends_of(
    folder: Path, mission: str, tests: str = TESTS, robot: str = ROBOT, engine: str = "auto"
) -> dict[str, Outcome]:
    project = write_project(folder, mission, tests, robot=robot)
    found = run(project, only=("*:reverse",), engine=engine)
    return {mutant.removeprefix("mission.py:"): outcome for mutant, outcome in found.items()}


def test_a_refusal_that_ends_the_process_is_no_kill(ends: dict[str, Outcome]) -> None:
    found = ends["refused.py"]
    assert (found.verdict, found.acted) == (Verdict.REFUSED, 1)
    assert found.message is not None
    assert "out of reach" in found.message


def test_a_crash_of_the_process_is_noticed_by_the_test_that_looks_at_it(ends: dict[str, Outcome]) -> None:
    assert (ends["crashes.py"].verdict, ends["crashes.py"].acted) == (Verdict.KILLED, 1)


def test_a_process_that_the_test_ends_by_a_program_is_judged_by_the_test(ends: dict[str, Outcome]) -> None:
    assert (ends["stays.py"].verdict, ends["stays.py"].acted) == (Verdict.KILLED, 1)


def test_a_process_that_never_ends_times_out(ends: dict[str, Outcome]) -> None:
    assert ends["endless.py"].verdict is Verdict.TIMEOUT
    assert "processor time" in (ends["endless.py"].message or "")


def test_an_environment_of_its_own_does_not_hide_a_process(ends: dict[str, Outcome]) -> None:
    assert ends["bare.py"].verdict is Verdict.KILLED
    assert ends["spawned.py"].verdict is Verdict.KILLED


@pytest.mark.whole
def test_a_process_that_somebody_else_kills_says_nothing_about_its_mutant(tmp_path: Path) -> None:
    tests = """
        import os
        import subprocess
        import sys
        from pathlib import Path

        def test_mission():
            mission = subprocess.Popen([sys.executable, "mission.py"], stdout=subprocess.PIPE, text=True)
            for line in mission.stdout:
                if float(line) < 0:
                    Path(os.environ["VICTIM"]).write_text(str(mission.pid))
            assert mission.wait() == 0
    """
    with killer():  # by the system's process ids, which forks do not know
        found = ends_of(tmp_path, SCRIPTS["stays.py"], tests, engine="replay")[
            "<module>:arm.move_by#1:dx:reverse"
        ]
    assert found.verdict is Verdict.ERROR
    assert found.message == "the process mission.py was killed from outside, by signal 9"


@pytest.mark.whole
def test_a_process_that_the_test_ends_by_a_command_is_judged_by_the_test(tmp_path: Path) -> None:
    tests = """
        import subprocess
        import sys

        def test_mission():
            mission = subprocess.Popen([sys.executable, "mission.py"], stdout=subprocess.PIPE, text=True)
            for line in mission.stdout:
                if float(line) < 0:
                    subprocess.run(["kill", str(mission.pid)], check=True)
            assert mission.wait() == 0
    """
    found = ends_of(tmp_path, SCRIPTS["stays.py"], tests)["<module>:arm.move_by#1:dx:reverse"]
    assert (found.verdict, found.acted) == (Verdict.KILLED, 1)


@pytest.mark.whole
def test_a_process_that_fails_before_the_mutant_acts_is_an_error(tmp_path: Path) -> None:
    mission = """
        import os
        from pathlib import Path

        from robot import Arm

        runs = Path(os.environ["RUNS"])
        runs.write_text(runs.read_text() + "x" if runs.exists() else "x")
        if len(runs.read_text()) > int(os.environ["LIMIT"]):
            raise OSError("the licence server does not answer")
        arm = Arm()
        arm.move_by(0.5)
        print(arm.x)
    """
    project = write_project(tmp_path, mission, TESTS)
    with pytest.MonkeyPatch.context() as patch:
        # a folder that no run keeps to itself: two runs of the baseline, one of each control, two mutants
        patch.setenv("RUNS", f"/var/tmp/{tmp_path.name}-{id(tmp_path)}")
        patch.setenv("LIMIT", "5")
        try:
            found = run(project, engine="replay", fresh=True, jobs=1)
        finally:
            Path(f"/var/tmp/{tmp_path.name}-{id(tmp_path)}").unlink(missing_ok=True)
    failed = [
        outcome for outcome in found.values() if outcome.message and "licence server" in outcome.message
    ]
    assert failed
    assert {outcome.verdict for outcome in failed} == {Verdict.ERROR}
    assert all("ended before the mutant changed anything" in (outcome.message or "") for outcome in failed)


def test_what_keeps_apart_from_the_campaign_is_reported(tmp_path: Path) -> None:
    tests = """
        import os
        import subprocess
        import sys
        from posix import execve, posix_spawn  # as they were: mutabot's own are in os

        import mission

        def test_mission():
            assert mission.go() == 0.5

        def test_apart():
            subprocess.run([sys.executable, "-I", "-c", "pass"], check=True)

        def test_spawned():
            for environment in ({}, os.environ):
                arguments = [sys.executable, "-c", "'spawned'"]
                _, status = os.waitpid(posix_spawn(sys.executable, arguments, environment), 0)
                assert status == 0

        def test_executed():
            child = os.fork()
            if not child:
                execve(sys.executable, [sys.executable, "-c", "'executed'"], {})
            assert os.waitpid(child, 0) == (child, 0)
    """
    mission = """
        from robot import Arm

        def go():
            arm = Arm()
            arm.move_by(0.5)
            return arm.x
    """
    progress = Quiet()
    run_campaign(request_for(write_project(tmp_path, mission, tests)), progress)
    notes = [line for line in progress.lines if "nothing in this process is seen or mutated" in line]
    assert len(notes) == 3
    assert "the option -I isolates it" in notes[0]
    for name, note in zip(("spawned", "executed"), notes[1:], strict=True):
        assert name in note
        assert "its environment lacks PYTHONPATH and MUTABOT_PROCESSES" in note


@pytest.mark.needs("source")
@pytest.mark.whole
def test_a_script_sees_itself_as_ever_when_its_text_is_mutated(tmp_path: Path) -> None:
    mission = '''
        """What it does."""
        from __future__ import annotations

        import sys

        own = (__name__, __spec__, __package__, __doc__, __file__ == sys.argv[1], sys.path[0] == sys.argv[2])
        size = 3
        print(own, sys.argv[0], size)
    '''
    tests = """
        import os
        import subprocess
        import sys

        def test_own():
            place = os.path.abspath("mission.py")
            told = subprocess.run([sys.executable, "mission.py", place, os.path.dirname(place)],
                                  capture_output=True, text=True, check=True).stdout
            assert told == "('__main__', None, None, 'What it does.', True, True) mission.py 3\\n"
    """
    found = run(write_project(tmp_path, mission, tests), fresh=True, families=("conventional",))
    changed = [value for mutant, value in found.items() if ":3#1:" in mutant]
    assert changed
    assert {outcome.verdict for outcome in changed} == {Verdict.KILLED}


@pytest.mark.needs("source")
@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_a_process_that_goes_on_after_its_test_reports_no_change_where_no_value_changed(
    tmp_path: Path, engine: str
) -> None:
    mission = """
        from robot import Arm

        def serve(orders, answers):
            arm = Arm()
            for order in orders:
                arm.move_by(float(order))
                answers.write(f"{arm.position()} {arm.x}\\n")
                answers.flush()
    """
    tests = """
        import os

        import mission
        import pytest

        @pytest.fixture(scope="session")
        def ask():
            (orders, order), (answer, answers) = os.pipe(), os.pipe()
            child = os.fork()
            if not child:
                os.close(order)
                try:
                    mission.serve(os.fdopen(orders), os.fdopen(answers, "w"))
                finally:
                    os._exit(0)
            os.close(orders)
            os.close(answers)
            with os.fdopen(order, "w", buffering=1) as given, os.fdopen(answer) as taken:
                yield lambda text: (given.write(text), taken.readline())[1]
            os.waitpid(child, 0)

        def test_the_first(ask):
            assert ask("0.25\\n") == "0.25 0.25\\n"

        def test_the_second(ask):
            assert ask("0.25\\n") == "0.5 0.5\\n"
    """
    project = write_project(tmp_path, mission, tests)
    engine = "auto" if engine == "fork" else engine
    found = run(project, families=("conventional",), only=("*:ABS=abs",), engine=engine)
    assert len(found) == 3  # of what is ordered, of what is read, of the attribute: all are positive
    assert {outcome.verdict for outcome in found.values()} == {Verdict.NO_EFFECT}


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_a_copy_of_the_process_that_becomes_another_program_is_seen_until_then(
    tmp_path: Path, engine: str
) -> None:
    mission = """
        import os
        import subprocess

        from robot import Arm

        ARM, EDGE = Arm(), Arm(x=-0.9)

        def prepare():
            ARM.move_by(0.25)
            EDGE.move_by(0.4)
            if ARM.x < 0:
                raise ValueError("behind")

        def start():
            return subprocess.run(["true"], preexec_fn=prepare).returncode

        def copy():
            child = os.fork()
            if not child:
                os.execv("/bin/sh", ["sh", "-c", "exit 0"])
            return os.waitpid(child, 0)[1]
    """
    tests = """
        import mission

        def test_start():
            assert mission.start() == 0

        def test_copy():
            assert mission.copy() == 0
    """
    project = write_project(tmp_path, mission, tests)
    wanted = ("*:reverse", "*:os.fork()#1:ABS=abs")
    found = run(project, families=("robot", "conventional"), only=wanted, engine=engine)
    ends = {mutant.split(":")[2]: outcome.verdict for mutant, outcome in found.items()}
    assert ends == {
        "ARM.move_by#1": Verdict.KILLED,
        "EDGE.move_by#1": Verdict.REFUSED,
        "os.fork()#1": Verdict.NO_EFFECT,
    }
