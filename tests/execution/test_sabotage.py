"""Mutants that make their process write where mutabot's reports go, or delete its folders.

Each is an error of its own; all others end as they do in the same project without.
"""

from __future__ import annotations

import re
from pathlib import Path
from textwrap import dedent, indent

import pytest

from campaign.project import REPLAY, Quiet, outcomes, request_for, write_project
from mutabot.campaign.run import run_campaign
from mutabot.errors import BaselineError
from mutabot.journal.journal import Journal
from mutabot.model import Outcome, Verdict
from mutabot.results.results import read_results

MISSION = """
    def approach(arm):
        arm.move_by(0.25)
        return arm.position()

    def turn(arm):
        arm.move_by(0.125)

    def retreat(arm):
        arm.move_by(-0.5)
"""
TESTS = """
    import mission
    from robot import Arm

    def test_approach():
        arm = Arm()
        mission.approach(arm)
        assert arm.x == 0.25

    def test_turn():
        arm = Arm()
        mission.turn(arm)
        assert arm.x == 0.125

    def test_retreat():
        arm = Arm()
        mission.retreat(arm)
        assert arm.x == -0.5
"""
#: the robot of these tests; ``harm`` is called by the mutant that reverses the first move, and by no other
ROBOT = """
    class Refused(Exception):
        pass

    class Diverged(Exception):
        pass

    class Broken(AssertionError):
        pass

    class Arm:
        def __init__(self, x=0.0):
            self.x = x

        def move_by(self, dx):
            if dx == -0.25:
                harm()
            self.x += dx

        def position(self):
            return self.x

    def opened(is_reported):
        import os, stat
        for name in os.listdir("/proc/self/fd"):
            try:
                status, target = os.fstat(int(name)), os.readlink(f"/proc/self/fd/{name}")
            except OSError:
                continue
            flags = open(f"/proc/self/fdinfo/{name}").read().split("flags:")[1].split()[0]
            is_kind = target.endswith(".jsonl") if is_reported else stat.S_ISFIFO(status.st_mode)
            if is_kind and int(flags, 8) & 3 and int(name) > 2:
                yield int(name)

    def home():
        import os
        return os.path.dirname(os.environ["MUTABOT_PROCESSES"])

    def harm():
"""
GARBAGE = """
        import json, os, random
        forged = {
            "type": "ForkTestEnd",
            "mutant": "mission.py:retreat:arm.move_by#1:call:skip",
            "end": {"test": "tests/test_mission.py::test_retreat", "outcome": "passed", "acted": 1},
        }
        lines = [
            random.Random(1).randbytes(300),
            b"[" * 100_000,
            b'{"type":"TestEnd","test":5,"outcome":[]}',
            b'{"type":"SessionEnd","exit_status":0}',
            b'{"type":"TokensHeld","held":1000000}',
            json.dumps(forged).encode(),
            b"0123456789abcdef " + json.dumps(forged).encode(),
            b"half a li",
        ]
        for descriptor in opened({is_reported}):
            try:
                flags = open(f"/proc/self/fdinfo/{descriptor}").read()
                os.write(descriptor, b"\\n" + b"\\n".join(lines))
            except OSError:
                pass
"""


INTO_REPORT, INTO_PIPES = (
    GARBAGE.replace("{is_reported}", str(is_reported)) for is_reported in (True, False)
)


def project(folder: Path, harm: str = "pass") -> Path:
    return write_project(folder, MISSION, TESTS, robot=dedent(ROBOT) + indent(dedent(harm), "    "))


def run(folder: Path, **changes: object) -> tuple[dict[str, Outcome], Quiet, Path]:
    told = Quiet()
    path = run_campaign(request_for(folder, **changes), told)
    return {outcome.mutant: outcome for outcome in outcomes(path)}, told, path


def ends(found: dict[str, Outcome]) -> dict[str, object]:
    return {
        name: (outcome.verdict, outcome.by, outcome.test, outcome.message) for name, outcome in found.items()
    }


@pytest.fixture(scope="module")
def harmless(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Outcome]:
    found, _, _ = run(project(tmp_path_factory.mktemp("harmless")))
    assert {outcome.verdict for outcome in found.values()} >= {Verdict.KILLED, Verdict.SURVIVED}
    return found


def harmful_of(found: dict[str, Outcome]) -> str:
    """The mutant that does harm: it reverses the first move."""
    return next(name for name in found if "approach" in name and "reverse" in name)


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_a_mutant_that_writes_into_its_report_is_an_error_and_no_other_ends_otherwise(
    tmp_path: Path, harmless: dict[str, Outcome], engine: str
) -> None:
    found, _, path = run(project(tmp_path, INTO_REPORT), engine=engine)
    harmful = harmful_of(found)
    assert found[harmful].verdict is Verdict.ERROR
    assert found[harmful].message is not None
    assert "the tests' process reported something unreadable: b'" in found[harmful].message
    assert "(during tests/test_mission.py::test_approach)" in found[harmful].message
    mine, others = ends(found), ends(harmless)
    del mine[harmful], others[harmful]
    assert mine == others
    with Journal.open(path) as journal:
        assert read_results(journal).state == "complete"


#: what becomes of the process's own report, and what is said of it, as far as it had been read by then; in
#: the short run one of them: what is found of each in a report, ``test_event_file`` says
SPOILT = [
    pytest.param(
        "import os; os.write(own, b'half an ev'); os.kill(os.getpid(), 9)",
        "in the midst of",
        id="killed in a write",
    ),
    pytest.param(
        "import os; os.truncate(own, 10)",
        "is shorter than it was|reported something unreadable",
        id="shortened",
        marks=pytest.mark.whole,
    ),
    pytest.param(
        "import os; os.write(own, os.pread(os.open(f'/proc/self/fd/{own}', 0), 10**6, 0))",
        "comes twice",
        id="repeated",
        marks=pytest.mark.whole,
    ),
]


@pytest.mark.parametrize(("harm", "said"), SPOILT)
def test_a_mutant_that_spoils_its_own_report_is_an_error_and_no_other_ends_otherwise(
    tmp_path: Path, harmless: dict[str, Outcome], harm: str, said: str
) -> None:
    found, _, _ = run(project(tmp_path, f"own = list(opened(True))[0]; {harm}"))
    harmful = harmful_of(found)
    assert found[harmful].verdict is Verdict.ERROR
    assert re.search(said, found[harmful].message or "")
    mine, others = ends(found), ends(harmless)
    del mine[harmful], others[harmful]
    assert mine == others


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_what_a_mutant_writes_into_the_pipe_means_nothing(
    tmp_path: Path, harmless: dict[str, Outcome], engine: str
) -> None:
    found, _, _ = run(project(tmp_path, INTO_PIPES), engine=engine)
    assert ends(found) == ends(harmless)


def test_where_each_run_writes_into_its_report_the_baseline_says_so(tmp_path: Path) -> None:
    folder = project(tmp_path, INTO_REPORT)
    tests = folder / "tests/test_mission.py"
    tests.write_text(f"{tests.read_text()}\n\ndef test_harm():\n    import robot\n    robot.harm()\n")
    with pytest.raises(BaselineError, match=r"unreadable: b.* \(during tests/test_mission.py::test_harm\)"):
        run(folder)


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_no_mutant_reaches_the_journal(tmp_path: Path, harmless: dict[str, Outcome], engine: str) -> None:
    harm = """
        import glob, os
        for name in glob.glob(".mutabot/journal*"):
            os.truncate(name, 0)
            os.rename(name, name + ".lost")
    """
    found, told, _ = run(project(tmp_path, harm), engine=engine)
    assert ends(found) == ends(harmless)
    assert not [line for line in told.lines if "nothing is lost" in line or "was restored" in line]


@pytest.mark.whole
def test_a_mutant_that_deletes_the_folder_of_its_process_is_an_error(
    tmp_path: Path, harmless: dict[str, Outcome]
) -> None:
    harm = "import shutil; shutil.rmtree(home(), ignore_errors=True)"
    found, _, _ = run(project(tmp_path, harm))
    harmful = harmful_of(found)
    assert found[harmful].verdict is Verdict.ERROR
    assert found[harmful].message is not None
    assert "was deleted or closed while it ran" in found[harmful].message
    mine, others = ends(found), ends(harmless)
    del mine[harmful], others[harmful]
    assert mine == others


@pytest.mark.whole
def test_a_mutant_that_deletes_the_job_of_its_process_ends_as_without(
    tmp_path: Path, harmless: dict[str, Outcome]
) -> None:
    harm = "import pathlib; pathlib.Path(home(), 'processes', 'job').unlink(missing_ok=True)"
    found, _, _ = run(project(tmp_path, harm))
    assert ends(found) == ends(harmless)


@pytest.mark.whole
@pytest.mark.parametrize(
    "is_private", [True, pytest.param(False, marks=pytest.mark.whole)], ids=["private files", "shared files"]
)
def test_a_mutant_that_deletes_the_folders_of_all_processes_ends_no_campaign(
    tmp_path: Path, harmless: dict[str, Outcome], is_private: bool
) -> None:
    harm = "import os, shutil; shutil.rmtree(os.path.dirname(home()), ignore_errors=True)"
    folder = project(tmp_path, harm)
    file = folder / "mutabot.toml"
    file.write_text(f"{file.read_text()}\nprivate_files = {str(is_private).lower()}\n")
    found, _, path = run(folder, jobs=1)
    harmful = harmful_of(found)
    assert found[harmful].verdict is Verdict.ERROR
    mine, others = ends(found), ends(harmless)
    del mine[harmful], others[harmful]
    assert mine == others
    with Journal.open(path) as journal:
        assert read_results(journal).state == "complete"
    assert not list((folder / ".mutabot").glob("work-*"))


#: what mutants do to every descriptor that they have, ``n``, one kind each
DEEDS = (
    "os.write(n, b'rubbish\\n' * 20)",
    "os.close(n)",
    "os.dup2(null, n)",
    "os.dup2(1, n)",
    "os.set_blocking(n, False); os.read(n, 1 << 16)",
    "os.write(os.open(f'/proc/self/fd/{n}', os.O_WRONLY | os.O_NONBLOCK), b'rubbish\\n' * 20)",
    "os.close(os.open(f'/proc/self/fd/{n}', os.O_WRONLY | os.O_NONBLOCK | os.O_TRUNC))",
    "os.ftruncate(n, 0)",
    "os.lseek(n, 0, 0); os.write(n, b'x')",
    "os.set_blocking(n, True); fcntl.flock(n, fcntl.LOCK_EX | fcntl.LOCK_NB)",
)
STEPS = tuple((number + 1) / 64 for number in range(len(DEEDS)))
HARMFUL = """
    import fcntl, os

    class Arm:
        def __init__(self):
            self.x = 0.0

        def move_by(self, dx):
            null = os.open(os.devnull, os.O_RDWR)
            for n in {descriptors}:
                try:
                    {deeds}
                except OSError:
                    pass
            os.close(null)
            self.x += dx
"""


@pytest.mark.parametrize("engine", ["auto", REPLAY])
def test_what_a_mutant_does_to_descriptors_touches_no_other(tmp_path: Path, engine: str) -> None:
    deeds = "".join(
        f"\n                    if dx == {-step}: {deed}" for step, deed in zip(STEPS, DEEDS, strict=True)
    )
    every = "[int(name) for name in os.listdir('/proc/self/fd') if int(name) > 2]"
    moves = "".join(f"def move_{n}(arm):\n    arm.move_by({step})\n" for n, step in enumerate(STEPS))
    tests = "import mission\nfrom robot import Arm\n" + "".join(
        f"def test_{n}():\n    arm = Arm()\n    mission.move_{n}(arm)\n    assert arm.x == {step}\n"
        for n, step in enumerate(STEPS)
    )
    robot = HARMFUL.format(descriptors=every, deeds=deeds)
    vocabulary = """
        [[operation]]
        call = "robot:Arm.move_by"
        arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    """
    folder = write_project(tmp_path, moves, tests, robot=robot, vocabulary=vocabulary)
    path = run_campaign(request_for(folder, engine=engine, only=("*:reverse", "*:skip")), Quiet())
    found = {outcome.mutant: outcome for outcome in outcomes(path)}
    harmful = {name for name in found if name.endswith("reverse")}
    assert len(harmful) == len(DEEDS)
    assert {found[name].verdict for name in harmful} <= {Verdict.KILLED, Verdict.ERROR}
    others = [found[name] for name in sorted(found.keys() - harmful)]
    assert [
        (outcome.verdict, outcome.engine, outcome.test, (outcome.message or "")[:14]) for outcome in others
    ] == [
        (Verdict.KILLED, engine.replace("auto", "fork"), f"tests/test_mission.py::test_{n}", "assert 0.0 == ")
        for n in range(len(STEPS))
    ]
