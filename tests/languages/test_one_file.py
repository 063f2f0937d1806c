"""A language is one file: dropped into a copy of the package, with nothing else edited."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.campaign.project import write_project
from tests.package_copy import copied, mutants, python

#: of programs whose lines are a word and a number, and of the interpreter below
STEPS = """
    from mutabot.languages.front_end import SiteName, SourcePosition


    class Steps:
        suffixes = (".steps",)

        def names(self, source):
            names, counts = {}, {}
            for number, line in enumerate(source.splitlines(), start=1):
                word = line.split()[0]
                counts[word] = counts.get(word, 0) + 1
                names[number, 0, number, len(line)] = SiteName(word, counts[word])
            return names

        def file_of(self, frame):
            return frame.f_locals["file"] if frame.f_code.co_qualname == "Interpreter.step" else None

        def position_of(self, frame):
            number, line = frame.f_locals["number"], frame.f_locals["line"]
            return SourcePosition((number, 0, number, len(line)), "steps")


    FRONT_END = Steps()
    """
INTERPRETER = """
    class Interpreter:
        def __init__(self, arm):
            self.arm = arm

        def run(self, file):
            with open(file) as lines:
                for number, line in enumerate(lines.read().splitlines(), start=1):
                    self.step(file, number, line)

        def step(self, file, number, line):
            word, amount = line.split()
            getattr(self, word)(float(amount))

        def move(self, amount):
            self.arm.move_by(amount)
    """
MISSION = "move 0.25\nmove 0.125\n"
TESTS = """
    from interpreter import Interpreter
    from robot import Arm

    def test_it_moves():
        arm = Arm()
        Interpreter(arm).run("mission.steps")
        assert arm.x == 0.375
    """


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a copy of the package, into which a language was dropped."""
    return copied(tmp_path_factory.mktemp("site"), {"languages/steps.py": STEPS})


def test_its_lines_are_sites_with_verdicts(site: Path, tmp_path: Path) -> None:
    more = {"interpreter.py": INTERPRETER, "mission.steps": MISSION}
    configuration = 'program = ["mission.steps"]\nvocabulary = ["robot.toml"]\n'
    write_project(tmp_path, "", TESTS, more=more, configuration=configuration)
    found = mutants(site, tmp_path, "run", "-o", "repeats=false", "--only", "*skip", "--only", "*reverse")
    verdicts = {name: one["rounds"][0]["verdict"] for name, one in found.items()}
    assert verdicts == {
        f"mission.steps:steps:move#{number}:{rule}": "killed"
        for number in (1, 2)
        for rule in ("dx:reverse", "call:skip")
    }
    # columns of the JSON are those of editors, which begin with 1
    spans = {name.split(":")[2]: one["span"] for name, one in found.items()}
    assert {name: (one["line"], one["end_column"]) for name, one in spans.items()} == {
        "move#1": (1, 10),
        "move#2": (2, 11),
    }


@pytest.mark.needs("source")
def test_its_text_has_no_mutants_and_that_is_told(site: Path, tmp_path: Path) -> None:
    (tmp_path / "program").mkdir()
    (tmp_path / "program" / "mission.steps").write_text(MISSION)
    code = (
        "import sys, pathlib\n"
        "from mutabot.faults import Project\n"
        "from mutabot_source.provider import SourceFaults\n"
        "project = Project(pathlib.Path(sys.argv[1]), ('program',), families=('conventional',))\n"
        "prepared = SourceFaults().prepare(project, 1)\n"
        "print(prepared.texts, *prepared.notes)\n"
    )
    told = python(site, "-c", code, str(tmp_path))
    assert told.startswith(
        "() no mutants of the text of program/mission.steps: it cannot be read: it is no Python"
    )
