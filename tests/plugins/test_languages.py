"""A language of a package, in Latin-1: lines of its programs are sites, and their text has mutants."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from tests.campaign.project import write_project
from tests.plugins.test_faults import write
from tests.plugins.test_plugins import mutabot

PACKAGE = {
    "steps.py": """
        from mutabot.api.faults import Activation, Extension, FaultProvider, Planned, PlannedMutant
        from mutabot.api.faults import Rule, Site

        EXTENSION = Extension(
            interface=2, languages={"steps": "steps:LANGUAGE"}, faults={"steps": "steps:StepFaults"}
        )

        class Steps:
            suffixes = (".steps",)

            def text_of(self, content):
                return content.decode("latin-1")

            def names(self, source):
                names, counts = {}, {}
                for number, line in enumerate(source.splitlines(), start=1):
                    word = line.split()[0]
                    counts[word] = counts.get(word, 0) + 1
                    names[number, 0, number, len(line.encode())] = (word, counts[word])
                return names

            def file_of(self, frame):
                return frame.f_locals["file"] if frame.f_code.co_qualname == "Interpreter.step" else None

            def position_of(self, frame):
                number, line = frame.f_locals["number"], frame.f_locals["line"]
                return (number, 0, number, len(line.encode())), "steps"

        LANGUAGE = Steps()

        class Drop(Rule):
            name = "drop"
            family = "steps"
            summary = "A line of a program is missing."

        class StepFaults(FaultProvider):
            name = "steps"
            families = ("steps",)
            location = "line"

            def rules(self):
                return [Drop()]

            def plan(self, project, original):
                planned = Planned()
                for name in project.program:
                    text = LANGUAGE.text_of((project.root / name).read_bytes())
                    lines = text.splitlines(keepends=True)
                    for (number, *extent), site_name in LANGUAGE.names(text).items():
                        site = Site.in_program(name, (number, *extent), "steps", *site_name)
                        mutant = self.mutant(Drop(), site, f"without {lines[number - 1].strip()}")
                        without = "".join(lines[: number - 1] + lines[number:])
                        active = Activation("steps_inside:Changed", [name, without])
                        planned.mutants.append(PlannedMutant(mutant, does=without, active=active))
                        for round, tests in enumerate(original.tests):
                            planned.reach(round, site, tests)
                return planned
        """,
    "steps_inside.py": """
        from mutabot.api.faults import ActiveFault

        class Changed(ActiveFault):
            def prepare_process(self):
                file, text = self.data
                self.context.change_file(file, text.encode("latin-1"))

            def start_test(self, test, random):
                self.acts()

            def end_test(self):
                pass
        """,
    "steps-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: steps\nVersion: 1.0\n",
    "steps-1.0.dist-info/entry_points.txt": "[mutabot]\nsteps = steps:EXTENSION\n",
}
INTERPRETER = """
    class Interpreter:
        def __init__(self, arm):
            self.arm, self.said = arm, []

        def run(self, file):
            with open(file, encoding="latin-1") as lines:
                for number, line in enumerate(lines.read().splitlines(), start=1):
                    self.step(file, number, line)

        def step(self, file, number, line):
            word, amount = line.split()
            getattr(self, word)(amount)

        def move(self, amount):
            self.arm.move_by(float(amount))

        def say(self, text):
            self.said.append(text)
    """
MISSION = "move 0.25\nsay Grüße\nmove 0.125\n"
TESTS = """
    from interpreter import Interpreter
    from robot import Arm

    def test_it_moves():
        arm = Arm()
        Interpreter(arm).run("mission.STEPS")
        assert arm.x == 0.375
    """


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = tmp_path / "project"
    configuration = 'program = ["mission.STEPS"]\nvocabulary = ["robot.toml"]\n'
    write_project(folder, "", TESTS, more={"interpreter.py": INTERPRETER}, configuration=configuration)
    (folder / "mission.STEPS").write_bytes(MISSION.encode("latin-1"))
    return folder


def mutants(site: Path, project: Path, *options: str) -> dict[str, Any]:
    done = mutabot(site, project, "run", "-o", "repeats=false", "--json", *options)
    assert done.returncode == 0, done.stderr
    return {mutant["id"]: mutant for mutant in json.loads(done.stdout)["mutants"]}


def test_its_lines_are_sites_with_verdicts(project: Path, tmp_path: Path) -> None:
    site = write(tmp_path / "site", PACKAGE)
    found = mutants(site, project, "--only", "*skip", "--only", "*reverse")
    verdicts = {name: mutant["rounds"][0]["verdict"] for name, mutant in found.items()}
    assert verdicts == {
        f"mission.STEPS:steps:move#{number}:{rule}": "killed"
        for number in (1, 2)
        for rule in ("dx:reverse", "call:skip")
    }
    # columns of the JSON are those of editors, which begin with 1
    spans = {name.split(":")[2]: mutant["span"] for name, mutant in found.items()}
    assert {name: (span["line"], span["end_column"]) for name, span in spans.items()} == {
        "move#1": (1, 10), "move#2": (3, 11),
    }  # fmt: skip
    report = json.loads(mutabot(site, project, "report", "--format", "mutation-testing").stdout)
    assert report["files"]["mission.STEPS"]["language"] == "steps"


@pytest.mark.parametrize("engine", ["fork", pytest.param("replay", marks=pytest.mark.whole)])
def test_its_text_has_mutants_of_the_package(engine: str, project: Path, tmp_path: Path) -> None:
    site = write(tmp_path / "site", PACKAGE)
    found = mutants(site, project, "-o", "families=['steps']", "--engine", engine)
    assert {mutant["rounds"][0]["engine"] for mutant in found.values()} == {engine}
    assert {mutant["description"]: mutant["rounds"][0]["verdict"] for mutant in found.values()} == {
        "without move 0.25": "killed", "without say Grüße": "survived", "without move 0.125": "killed",
    }  # fmt: skip
    assert (project / "mission.STEPS").read_bytes() == MISSION.encode("latin-1")


@pytest.mark.needs("source")
def test_that_python_has_no_mutants_of_its_text_is_reported(project: Path, tmp_path: Path) -> None:
    site = write(tmp_path / "site", PACKAGE)
    done = mutabot(site, project, "list", "-o", "families=['conventional']")
    assert "no mutants of the text of mission.STEPS: it is not Python" in done.stderr
