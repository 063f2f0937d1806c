"""A guard in a campaign: nothing outside reaches the robot, whoever made it so."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.config.options import Sample
from mutabot.errors import BaselineError
from mutabot.model import Outcome, Verdict
from tests.campaign.project import Quiet, outcomes, request_for
from tests.packages.hardware.robot_server import RobotServer, robot_server, write_project

PROGRAM = """
    import subprocess
    import sys
    import threading

    def move(arm, x, z, speed):
        arm.move_to(x, z, speed=speed)

    def move_on(arm, dx, dz):
        arm.move_by(dx=dx, dz=dz)

    def say(arm, z):
        arm.send(f"height {z}")

    def lift(arm, z):
        arm.lift = z

    def look(arm):
        place = arm.pose()
        return place["x"]

    def follow(arm):
        arm.move_to(look(arm), 0.5)

    def beside(arm, z):
        thread = threading.Thread(target=lift, args=(arm, z))
        thread.start()
        thread.join()

    def below():
        subprocess.run([sys.executable, "child.py"], check=False)
    """
CHILD = """
    import program
    from robot import Arm

    arm = Arm()
    for z in (0.2, 0.4, 0.6, 0.8):
        program.move(arm, 0.5, z, 0.1)
    """
#: each command is tried by itself, whatever came of the others
TESTS = """
    import random
    import threading

    import program
    import pytest
    from robot import Arm

    COMMANDS = {many}

    @pytest.fixture
    def arm():
        threading.excepthook = lambda arguments: None
        return Arm()

    def tried(command, *arguments):
        try:
            command(*arguments)
        except BaseException as error:
            if type(error).__name__ == "FatalFault":
                raise

    def test_many_commands(arm):
        draw = random.Random(1).uniform
        for _ in range(COMMANDS):
            tried(program.move, arm, draw(0.21, 0.69), draw(0.11, 0.89), draw(0.0, 0.25))
            tried(program.lift, arm, draw(0.11, 0.89))
            tried(program.say, arm, draw(0.11, 0.89))
            place = arm.pose()
            x, z = draw(0.21, 0.69), draw(0.11, 0.89)
            tried(program.move_on, arm, x - place["x"], z - place["z"])
            tried(program.follow, arm)
        tried(program.beside, arm, 0.5)

    def test_below():
        program.below()
    """


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Iterator[RobotServer]:
    with robot_server() as found:
        monkeypatch.setenv("ROBOT_PORT", str(found.port))
        yield found


def outcomes_of(folder: Path, engine: str, **changes: Any) -> list[Outcome]:
    return outcomes(run_campaign(request_for(folder, engine=engine, **changes), Quiet()))


#: families whose mutants send commands, and of how many mutants of them each sends so many
EVERY = ("robot", "graded", "catalogue", "conventional")


@pytest.mark.parametrize(
    ("engine", "families", "sample", "many", "least"),
    [
        ("auto", ("robot",), "6", 30, 500),
        pytest.param("auto", EVERY, "25", 150, 25_000, marks=pytest.mark.whole),
        pytest.param("replay", EVERY, "12", 60, 1_500, marks=pytest.mark.whole),
    ],
)
def test_no_mutated_command_outside_reaches_the_robot(
    tmp_path: Path,
    server: RobotServer,
    engine: str,
    families: tuple[str, ...],
    sample: str,
    many: int,
    least: int,
) -> None:
    write_project(tmp_path, PROGRAM, TESTS.replace("{many}", str(many)))
    (tmp_path / "child.py").write_text("\n".join(line[4:] for line in CHILD.splitlines()), encoding="utf-8")
    found = outcomes_of(tmp_path, engine, families=families, sample=Sample.parse(sample))
    server.settle()
    places = [line.split() for line in server.lines() if line.startswith("at")]
    speeds = [float(line.split()[1]) for line in server.lines() if line.startswith("speed")]
    outside = [
        place for place in places if not (0.2 <= float(place[1]) <= 0.7 and 0.1 <= float(place[2]) <= 0.9)
    ]
    assert len(places) > least
    assert outside == []
    assert [speed for speed in speeds if not speed <= 0.25 or math.isnan(speed)] == []
    assert sum(outcome.verdict is Verdict.GUARDED for outcome in found) > 1


SIMPLE = """
    def pick(arm):
        arm.move_to(0.4, 0.6)
        arm.move_by(dx=0.2)
        arm.grip(True)
    """
CHECKED = """
    import program
    from robot import Arm

    def test_it_picks():
        arm = Arm()
        program.pick(arm)
        assert arm.pose() == {"x": 0.6000000000000001, "z": 0.6}
    """


#: beside it a program that catches everything, and one that goes where a reading says
STOPPED = f"""{SIMPLE}
    def pick_whatever_is_raised(arm):
        try:
            arm.move_to(0.4, 0.6)
        except BaseException as error:
            if type(error).__name__ != "GuardedCall":
                raise
        arm.grip(True)

    def pick_here(arm):
        arm.move_to(arm.pose()["x"], 0.6)
    """
STOPPED_TESTS = f"""{CHECKED}
    def test_it_picks_whatever_is_raised():
        program.pick_whatever_is_raised(Arm())

    def test_it_picks_here():
        program.pick_here(Arm())
    """
REVERSED, OPPOSITE, SKIPPED, CAUGHT, READ = (
    f"program.py:{name}"
    for name in (
        "pick:arm.move_to#1:x:reverse",
        "pick:arm.grip#1:closed:opposite",
        "pick:arm.move_by#1:call:skip",
        "pick_whatever_is_raised:arm.move_to#1:x:reverse",
        "pick_here:arm.pose#1:['x']:negate",
    )
)


@pytest.fixture(scope="module", params=["auto", pytest.param("replay", marks=pytest.mark.whole)])
def stopped(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Outcome]:
    with robot_server() as server, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROBOT_PORT", str(server.port))
        folder = write_project(tmp_path_factory.mktemp("stopped"), STOPPED, STOPPED_TESTS)
        only = (REVERSED, OPPOSITE, SKIPPED, CAUGHT, READ)
        return {outcome.mutant: outcome for outcome in outcomes_of(folder, request.param, only=only)}


def test_a_mutant_that_a_guard_stops_is_outside_the_score(stopped: dict[str, Outcome]) -> None:
    assert stopped[REVERSED].verdict is Verdict.GUARDED
    assert not stopped[REVERSED].verdict.is_valid
    assert stopped[REVERSED].message == "robot:Arm.move_to: x leads to -0.4 m, the workspace is 0.2 to 0.7 m"
    assert stopped[OPPOSITE].verdict is Verdict.SURVIVED
    assert stopped[SKIPPED].verdict is Verdict.KILLED


def test_a_program_that_catches_everything_does_not_hide_that_a_guard_stopped_it(
    stopped: dict[str, Outcome],
) -> None:
    assert stopped[CAUGHT].verdict is Verdict.GUARDED


def test_what_a_wrong_reading_leads_to_is_stopped_as_well(stopped: dict[str, Outcome]) -> None:
    assert stopped[READ].verdict is Verdict.GUARDED
    assert "leads to -0.4 m" in str(stopped[READ].message)


@pytest.mark.parametrize(
    "engine", ["auto", *(pytest.param(name, marks=pytest.mark.whole) for name in ("fork", "replay"))]
)
def test_a_guard_that_the_original_violates_is_reported_before_anything_is_mutated(
    tmp_path: Path, server: RobotServer, engine: str
) -> None:
    guard = "[guard]\nbox = [{ x = [0.5, 0.7] }]\n"
    with pytest.raises(
        BaselineError, match=r"move_to: x leads to 0.4 m, the workspace is 0.5 to 0.7 m; widen"
    ):
        outcomes_of(write_project(tmp_path, SIMPLE, CHECKED, guard), engine)
    assert server.received == []


@pytest.mark.whole
def test_outcomes_found_without_a_guard_are_not_those_with_one(tmp_path: Path, server: RobotServer) -> None:
    write_project(tmp_path, SIMPLE, CHECKED, guard="")
    name = "program.py:pick:arm.move_to#1:x:reverse"
    before = {outcome.mutant: outcome.verdict for outcome in outcomes_of(tmp_path, "auto")}
    write_project(tmp_path, SIMPLE, CHECKED)
    after = {outcome.mutant: outcome.verdict for outcome in outcomes_of(tmp_path, "auto")}
    assert (before[name], after[name]) == (Verdict.KILLED, Verdict.GUARDED)


def test_a_guard_that_fails_lets_nothing_pass(tmp_path: Path, server: RobotServer) -> None:
    vocabulary_lacks_a_reading = "[guard]\nbox = [{ x = [0.2, 0.7], y = [0.0, 1.0], keep = 'out' }]\n"
    with pytest.raises(BaselineError, match="says nothing of y, so that a box to avoid cannot be compared"):
        outcomes_of(write_project(tmp_path, SIMPLE, CHECKED, vocabulary_lacks_a_reading), "auto")
