"""What is recorded of a campaign: of the original, and of mutants that differ from it."""

from __future__ import annotations

import shutil
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.journal.files import recordings_path
from mutabot.journal.journal import Journal
from mutabot.model import Outcome, Verdict
from mutabot.results.stored import StoredEvidence
from tests.campaign.project import REPLAY, Quiet, request_for, write_project

#: an arm that moves at 1 m/s and carries a part, and tells of both
ROBOT = """
    from mutabot.api.processes import Feed

    class Cell:
        def __init__(self):
            self.time, self.x, self.part, self.held = 0.0, 0.0, 0.5, False
            self.feed = Feed(lambda: self.time)
            self.feed.point("tool", lambda: (self.x, 0.0, 0.0))
            self.feed.point("part", lambda: (self.part, 0.0, 0.0), size=(0.1, 0.1, 0.1))
            self.feed.contacts(lambda: [("part", "gripper")] if self.held else [])
            self.feed.block("wall", (2.0, 0.0, 0.0), (0.1, 1.0, 1.0))

        def step(self):
            self.time += 0.05
            self.feed.tick()
            return self.time

    class Arm:
        def __init__(self, cell):
            self.cell = cell

        def move_by(self, dx):
            count = round(abs(dx) / 0.05)
            for _ in range(count):
                self.cell.x += dx / count
                if self.cell.held:
                    self.cell.part = self.cell.x
                self.cell.step()

        def grip(self, closed):
            self.cell.held = closed and abs(self.cell.x - self.cell.part) < 0.01
            self.cell.step()

        def position(self):
            return self.cell.x
"""
VOCABULARY = """
    clock = { tick = "robot:Cell.step", unit = "s" }

    [[operation]]
    call = "robot:Arm.move_by"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }

    [[operation]]
    call = "robot:Arm.grip"
    arguments.closed = { kind = "opening", values = [false, true] }
"""
MISSION = """
    def run(arm):
        arm.move_by(0.5)
        arm.grip(True)
        arm.move_by(0.5)
        arm.grip(False)
        arm.move_by(-0.25)
"""
TESTS = """
    import mission
    from robot import Arm, Cell

    def test_carries():
        cell = Cell()
        mission.run(Arm(cell))
        assert cell.x > 0.5
"""
TEST = "tests/test_mission.py::test_carries"
#: mutants where it does not matter which
SOME = ("*arm.grip#1*",)


def project(folder: Path, configuration: str = "") -> Path:
    lines = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\npytest_args = ["-o", "pythonpath=."]\n'
    return write_project(
        folder, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY, configuration=lines + configuration
    )


def ran(folder: Path, engine: str = "auto", **details: object) -> dict[str, Outcome]:
    """The outcomes by mutant, of a campaign that records."""
    request = replace(request_for(folder, engine=engine), evidence=True, **details)  # type: ignore[arg-type]
    with Journal.open(run_campaign(request, Quiet())) as journal:
        return {outcome.mutant.partition("run:")[2]: outcome for outcome in journal.outcomes()}


def evidence(folder: Path) -> closing[StoredEvidence]:
    return closing(StoredEvidence(folder / ".mutabot" / "journal.sqlite"))


@pytest.fixture(scope="module", params=["fork", REPLAY])
def recorded(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, dict[str, Outcome]]:
    """A campaign of which many tests ask: its folder, and the outcomes."""
    folder = project(tmp_path_factory.mktemp("recorded"))
    return folder, ran(folder, request.param)


def test_what_happened_is_reported(recorded: tuple[Path, dict[str, Outcome]]) -> None:
    _, found = recorded
    dropped = found["arm.grip#2:call:skip"]
    assert dropped.verdict is Verdict.SURVIVED
    (diverged,) = dropped.diverged
    assert diverged.story.startswith("part was never let go (original: at 1.1 s)")
    assert diverged.fault == pytest.approx(1.0)
    assert diverged.is_simulated
    (part,) = [deviation for deviation in diverged.apart if deviation.name == "part"]
    assert part.final == pytest.approx(0.25)
    missed = found["arm.grip#1:call:skip"].diverged[0]
    assert missed.story.startswith("gripper never touched part (original: at ")


def test_a_mutant_that_was_killed_is_recorded_up_to_its_end(
    recorded: tuple[Path, dict[str, Outcome]],
) -> None:
    folder, found = recorded
    killed = found["arm.move_by#2:dx:reverse"]
    assert killed.verdict is Verdict.KILLED
    with evidence(folder) as stored:
        original, mutant = stored.pair(killed.mutant, 0, TEST)
    assert original is not None
    assert mutant is not None
    assert mutant.faulty_call == 2
    assert [call.operation for call in mutant.calls] == [call.operation for call in original.calls]
    assert mutant.tracks["tool"].values[-3] == pytest.approx(-0.25, abs=0.051)


def test_what_differs_in_nothing_is_not_kept(
    recorded: tuple[Path, dict[str, Outcome]], tmp_path: Path
) -> None:
    folder, same = tmp_path / "project", recorded[1]["arm.grip#2:call:repeat"]
    shutil.copytree(recorded[0], folder)
    again = same.diverged[0]  # it takes a step longer
    assert again.story == "the same movements happened at most 0.1 s earlier or later"
    mission = (folder / "mission.py").read_text()
    (folder / "mission.py").write_text(
        mission.replace("arm.move_by(-0.25)", "arm.move_by(-0.25); arm.move_by(1e-9)")
    )
    still = ran(folder)["arm.move_by#4:dx:reverse"]
    assert (still.verdict, still.diverged) == (Verdict.SURVIVED, ())
    with evidence(folder) as stored:
        assert stored.tests(still.mutant, 0) == ()
        assert stored.tests(again.test and same.mutant, 0) == (TEST,)


def test_outcomes_that_are_taken_over_keep_their_recordings(
    recorded: tuple[Path, dict[str, Outcome]], tmp_path: Path
) -> None:
    folder, first = tmp_path / "project", recorded[1]
    shutil.copytree(recorded[0], folder)
    path = recordings_path(folder / ".mutabot" / "journal.sqlite")
    written = path.stat().st_size
    second = ran(folder)
    assert second == first
    assert path.stat().st_size <= 2 * written
    with evidence(folder) as stored:
        assert stored.pair(first["arm.grip#2:call:skip"].mutant, 0, TEST)[1] is not None


def test_where_room_is_short_some_are_left_out_and_that_is_said(tmp_path: Path) -> None:
    folder = project(tmp_path, 'evidence = "7 kB"\n')
    request = replace(request_for(folder), evidence=True)
    progress = Quiet()
    with Journal.open(run_campaign(request, progress)) as journal:
        outcomes = journal.outcomes()
    with evidence(folder) as stored:
        kept = {outcome.mutant for outcome in outcomes if stored.tests(outcome.mutant, 0)}
        assert stored.tests("", 0) == (TEST,)
        used = sum(path.stat().st_size for path in folder.glob(".mutabot/*-evidence.sqlite"))
    assert len(kept) < len([outcome for outcome in outcomes if outcome.diverged])
    assert used < 50_000
    assert any("set `evidence` to more" in line for line in progress.lines)
    assert all(outcome.diverged for outcome in outcomes if outcome.verdict is Verdict.KILLED)


def test_nothing_is_recorded_where_that_is_not_asked_for(tmp_path: Path) -> None:
    folder = project(tmp_path)
    with Journal.open(run_campaign(request_for(folder, only=SOME), Quiet())) as journal:
        assert all(outcome.diverged == () for outcome in journal.outcomes())
    assert not recordings_path(folder / ".mutabot" / "journal.sqlite").exists()


def test_a_program_without_a_feed_is_recorded_by_its_calls(tmp_path: Path) -> None:
    robot = ROBOT.replace("self.feed.tick()", "pass")
    lines = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\npytest_args = ["-o", "pythonpath=."]\n'
    folder = write_project(tmp_path, MISSION, TESTS, robot=robot, vocabulary=VOCABULARY, configuration=lines)
    ran(folder, only=SOME)
    with evidence(folder) as stored:
        original, _ = stored.pair("", 0, TEST)
    assert original is not None
    assert not original.times
    # the clock of the vocabulary tells the time since its first tick
    assert [call.began for call in original.calls] == pytest.approx([0.0, 0.45, 0.5, 1.0, 1.05])


def test_a_feed_that_fails_is_said_once(tmp_path: Path) -> None:
    robot = ROBOT.replace("(self.part, 0.0, 0.0), size", "(self.part, 0.0), size")
    lines = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\npytest_args = ["-o", "pythonpath=."]\n'
    folder = write_project(tmp_path, MISSION, TESTS, robot=robot, vocabulary=VOCABULARY, configuration=lines)
    progress = Quiet()
    run_campaign(replace(request_for(folder, only=SOME), evidence=True), progress)
    assert progress.lines.count("part cannot be recorded: 2 numbers instead of 3") == 1


@pytest.mark.whole
def test_what_a_process_of_its_own_does_is_recorded_in_its_order(tmp_path: Path) -> None:
    mission = """
        import time
        from robot import Arm, Cell

        arm = Arm(Cell())
        arm.move_by(0.5)
        time.sleep(0.05)
        arm.grip(True)
    """
    tests = """
        import subprocess
        import sys

        def test_mission():
            subprocess.run([sys.executable, "mission.py"], check=True, timeout=60)
    """
    lines = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\npytest_args = ["-o", "pythonpath=."]\n'
    vocabulary = VOCABULARY.replace('clock = { tick = "robot:Cell.step", unit = "s" }', "")
    folder = write_project(tmp_path, mission, tests, robot=ROBOT, vocabulary=vocabulary, configuration=lines)
    ran(folder, only=("*move_by*:skip",))
    with evidence(folder) as stored:
        original, _ = stored.pair("", 0, "tests/test_mission.py::test_mission")
    assert original is not None
    first, second = original.calls
    assert (first.operation, second.operation) == ("robot:Arm.move_by", "robot:Arm.grip")
    assert first.began is not None
    assert second.began is not None
    assert second.began - first.began >= 0.05
    assert not original.is_simulated


TWICE = """

    def test_carries_again():
        cell = Cell()
        mission.run(Arm(cell))
        assert cell.x > 0.5
"""


def test_where_several_tests_differ_each_line_names_its_test(tmp_path: Path) -> None:
    probe = '\n    [[probe]]\n    call = "robot:Arm.position"\n'
    folder = write_project(
        tmp_path, MISSION, TESTS + TWICE, robot=ROBOT, vocabulary=VOCABULARY + probe,
        configuration='program = ["mission.py"]\nvocabulary = ["robot.toml"]\n'
        'pytest_args = ["-o", "pythonpath=."]\n',
    )  # fmt: skip
    (outcome,) = ran(folder, rounds=1, only=("*arm.move_by#3*skip*",)).values()
    assert outcome.verdict is Verdict.SURVIVED
    named = {line.rpartition(" (in ")[2] for line in outcome.divergence}
    assert named == {"test_carries)", "test_carries_again)"}


#: an arm whose part lies elsewhere with each seed
SEEDED = ROBOT.replace(
    "self.part, self.held = 0.0, 0.0, 0.5, False", "self.part, self.held = 0.0, 0.0, part, False"
).replace("def __init__(self):", "def __init__(self, part):")
SEEDED_TESTS = """
    import mission
    from robot import Arm, Cell

    def test_carries(mutabot_seed):
        cell = Cell(0.5)
        mission.run(Arm(cell))
        cell.part += (mutabot_seed % 1000) / 1000  # bumped by whatever goes by
        cell.step()
        assert cell.x > 0.5
"""


def test_with_one_round_the_original_runs_with_more_seeds(tmp_path: Path) -> None:
    folder = write_project(
        tmp_path, MISSION, SEEDED_TESTS, robot=SEEDED, vocabulary=VOCABULARY,
        configuration='program = ["mission.py"]\nvocabulary = ["robot.toml"]\n'
        'pytest_args = ["-o", "pythonpath=."]\n',
    )  # fmt: skip
    (outcome,) = ran(folder, rounds=1, only=("*arm.grip#2*skip*",)).values()
    assert outcome.verdict is Verdict.SURVIVED
    (diverged,) = outcome.diverged
    assert diverged.scatters.startswith("part by ")
    (part,) = [deviation for deviation in diverged.apart if deviation.name == "part"]
    assert part.spread > 0.1
    assert part.deviation == pytest.approx(max(part.final / part.spread, part.aside / part.aside_spread))
    assert "part ended" not in diverged.story
    with evidence(folder) as found:
        assert not found.tests(outcome.mutant, 1)
