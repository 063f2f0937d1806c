"""A mutant's test filmed beside the original's, from the command line to the video."""

from __future__ import annotations

from pathlib import Path

import pytest

from campaign.project import write_project
from mutabot.cli.app import main
from mutabot.journal.files import JOURNAL
from mutabot.journal.reader import JournalReader
from mutabot_motion.filming import choose_graphics

ROBOT = """
    class Arm:
        def __init__(self):
            self.x = 0.0

        def go(self, dx):
            self.move_by(dx)

        def move_by(self, dx):
            self.x += dx

        def position(self):
            return self.x
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Arm.go"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }

    [[operation]]
    call = "robot:Arm.position"
    result = { kind = "position", axis = "x", unit = "m", noise = 0.5 }
"""
MISSION = """
    def run(arm):
        arm.go(0.25)
        arm.go(0.5)
"""
#: the feed reads by the vocabulary's own operations, and the camera paints where the arm is
TESTS = """
    import pytest
    import mission
    from mutabot.api.processes import Feed
    from robot import Arm

    @pytest.fixture
    def arm(monkeypatch):
        arm, time, move = Arm(), [0.0], Arm.move_by
        feed = Feed(lambda: time[0])
        feed.point("tool", lambda: (arm.position(), 0.0, 0.0))
        feed.camera(lambda: picture(arm), rate=10)

        def move_slowly(self, dx):
            for _ in range(5):
                move(self, dx / 5)
                time[0] += 0.1
                feed.tick()

        feed.tick()
        monkeypatch.setattr(Arm, "move_by", move_slowly)
        return arm

    def picture(arm):
        width = 120
        place = int(arm.position() * 100)
        row = b"".join(b"\\xff\\xff\\xff" if x == place else b"\\x10\\x20\\x30" for x in range(width))
        return memoryview(row * 90).cast("B", (90, width, 3))

    def test_it_moves(arm):
        mission.run(arm)
        assert arm.x > 0
"""


@pytest.mark.whole
def test_original_and_mutant_are_filmed_and_the_feed_makes_no_mutants(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    av = pytest.importorskip("av")
    pytest.importorskip("PIL")
    monkeypatch.chdir(write_project(tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY))
    assert main(["run", "--only", "skip", "-o", "repeats=false", "-j", "1"]) == 0
    assert "pictures" not in capsys.readouterr().err
    with JournalReader.open(Path(".mutabot", JOURNAL)) as journal:
        mutants = journal.mutants()
    assert {mutant.site.text for mutant in mutants} == {"arm.go"}, (
        "what the feed reads is no call of the program's"
    )

    skip = next(str(mutant.number) for mutant in mutants if mutant.operator == "skip")
    assert main(["motion", skip, "--video", "a.mp4", "-j", "1"]) == 0
    _, err = capsys.readouterr()
    assert "a.mp4: " in err
    assert "drawn" not in err
    with av.open("a.mp4") as video:
        assert next(video.decode(video=0)).width > 2 * 480
    assert [path.name for path in tmp_path.glob("*.mp4")] == ["a.mp4"]
    assert "film, simulated seconds" in err
    assert main(["report", "--html", "report"]) == 0
    assert Path("report", "data", "films", f"{skip}.mp4").read_bytes() == Path("a.mp4").read_bytes()


def test_what_the_user_has_chosen_to_draw_with_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", "osmesa")
    choose_graphics()
    assert __import__("os").environ["MUJOCO_GL"] == "osmesa"
