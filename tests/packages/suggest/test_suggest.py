"""``mutabot suggest`` on a small project with tests in three styles: what it suggests really kills."""

from __future__ import annotations

import re
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from mutabot.cli.app import main
from mutabot.journal.journal import Journal
from results import samples
from suites.corpus import PROJECTS, copied

from .projects import STYLES, TESTS, found_by, make, passes, patched

SUGGEST = ["suggest", "--seeds", "5"]


DOCUMENT = Path(__file__).parents[3] / "docs" / "suggest.md"


def survivors(found: dict[str, Any]) -> set[str]:
    """The ids of mutants that a campaign let through."""
    return {mutant["id"] for mutant in found["mutants"] if mutant["rounds"][0]["verdict"] == "survived"}


def killed(found: dict[str, Any]) -> set[str]:
    """The ids of mutants that suggestions are said to kill."""
    return {kill["mutant"]["id"] for suggestion in found["suggestions"] for kill in suggestion["kills"]}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project without tests."""
    monkeypatch.chdir(make(tmp_path, {}))
    return tmp_path


@pytest.mark.whole
@pytest.mark.parametrize("files", [["test_functions.py"], list(TESTS)], ids=["one", "all"])
def test_what_is_suggested_kills_when_it_is_applied(
    files: list[str], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make(folder, {name: TESTS[name] for name in files})
    before = survivors(found_by(["run"], capsys))
    tree = {path: path.read_bytes() for path in folder.rglob("*.*") if ".mutabot" not in path.parts}

    found = found_by(SUGGEST, capsys)

    assert {path: path.read_bytes() for path in tree} == tree, "the user's tree has changed"
    assert {suggestion["style"] for suggestion in found["suggestions"]} == {
        STYLES[name] for name in files if name in STYLES
    }
    left = {survivor["mutant"]["id"] for survivor in found["unsolved"]}
    assert killed(found) | left == before
    assert killed(found).isdisjoint(left)
    section = DOCUMENT.read_text(encoding="utf-8").partition("\n## JSON\n")[2]
    documented = set(re.findall(r"`(\w+)`", section))
    parts = [found, *found["suggestions"], *found["unsolved"], *found["suggestions"][0]["kills"]]
    assert {key for part in parts for key in part} <= documented
    patched(folder, found["diff"])
    assert passes(folder)[0] == 0
    in_diff = {
        "suggestions": [suggestion for suggestion in found["suggestions"] if not suggestion["by_hand"]]
    }
    assert (len(in_diff["suggestions"]) < len(found["suggestions"])) == (len(files) > 1)
    # checks that kill one mutant may kill more than was promised
    assert survivors(found_by(["run"], capsys)) <= before - killed(in_diff)


@pytest.mark.whole
def test_the_page_lists_what_is_suggested_for_the_project_with_all_kinds_of_quantities(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    project = copied(PROJECTS / "fault_catalogue", tmp_path / "cell")
    monkeypatch.chdir(project)
    found_by(["run"], capsys)
    suggested = {suggestion["statement"] for suggestion in found_by(SUGGEST, capsys)["suggestions"]}
    rows = re.findall(
        r"^\| fault_catalogue \| `(.+?)` \|", DOCUMENT.read_text(encoding="utf-8"), re.MULTILINE
    )
    assert {statement.removeprefix("assert ").replace("pytest.", "") for statement in suggested} == {*rows}


STATE_ROBOT = """
    class Tank:
        def __init__(self):
            self.level, self.alarm = 0.0, False

        def fill(self, amount):
            self.level += amount

        def set_alarm(self, on):
            self.alarm = on

        def state(self):
            return {"level": self.level, "alarm": self.alarm}
"""
STATE_PROGRAM = """
    def fill(tank):
        tank.fill(40.0)

    def drain(tank):
        if tank.level > 20.0:
            tank.set_alarm(True)
"""
STATE_TESTS = """
    import pytest
    from mission import drain, fill
    from robot import Tank

    @pytest.fixture(scope="module")
    def tank():
        return Tank()

    def test_fill(tank):
        fill(tank)
        assert tank.level == 40.0

    def test_drain(tank):
        drain(tank)
        assert tank.level == 40.0
"""
STATE_VOCABULARY = """
    [[probe]]
    call = "robot:Tank.state"
    tolerance = 0.001

    [[operation]]
    call = "robot:Tank.fill"

    [[operation]]
    call = "robot:Tank.set_alarm"
"""


@pytest.mark.whole
def test_a_test_that_reaches_the_survivor_only_after_another_one_is_looked_at_after_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    make(tmp_path, {"test_tank.py": STATE_TESTS}, STATE_PROGRAM)
    settings = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\n'
    texts = {"robot.py": STATE_ROBOT, "robot.toml": STATE_VOCABULARY, "mutabot.toml": settings}
    for name, text in texts.items():
        (tmp_path / name).write_text(dedent(text))
    monkeypatch.chdir(tmp_path)
    assert main(["run", "--only", "*set_alarm*skip"]) == 0
    capsys.readouterr()
    (suggestion,) = found_by(["suggest", "--seeds", "3"], capsys)["suggestions"]
    assert suggestion["test"] == "tests/test_tank.py::test_drain"
    assert "alarm" in suggestion["statement"]


def test_what_cannot_get_a_check_is_refused_with_the_true_reason(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / ".mutabot").mkdir()
    decision = {"why": "no matter", "source": "mutabot-accepted.toml:4", "date": "2026-01-31"}
    accepted = {"mutants": {samples.SKIP.id: decision}, "unmatched": []}
    path = samples.write_journal(folder / ".mutabot" / "journal.sqlite", accepted=accepted)
    assert main(["suggest", "--only", samples.SKIP.id]) == 3
    assert "these survivors are accepted" in capsys.readouterr().err
    with Journal.prepare(path, meta=samples.meta()) as journal:  # as `mutabot run --only 1` does
        journal.begin(samples.meta())
        journal.set_plan([samples.REVERSE], (), sources={})
        journal.add_outcome(samples.OUTCOMES[0])
        journal.finish("complete")
    assert main(["suggest", "--only", samples.NEGATE.id]) == 3
    assert "the last campaign did not run these mutants" in capsys.readouterr().err


def test_there_must_be_something_to_suggest_checks_for(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["suggest"]) == 2
    assert "mutabot run" in capsys.readouterr().err
    with Journal.prepare(folder / ".mutabot" / "journal.sqlite", meta={}) as journal:
        journal.begin({})
        journal.finish("complete")
    assert main(["suggest"]) == 3
    assert "no mutants" in capsys.readouterr().err
