"""Typing mistakes in ``--only`` and ``--skip`` are told before the tests run for the first time."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.typos import refuse_typos
from mutabot.cli.app import main
from mutabot.errors import SelectionError
from tests.campaign.project import request_for, write_project

MISSION = "def run(arm):\n    arm.move_by(0.25)\n"
TESTS = """
    from pathlib import Path
    import mission
    from robot import Arm

    Path(__file__).with_name("was_run").touch()

    def test_run():
        mission.run(Arm())
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("typos")
    configuration = 'program = ["mission.py", "cell"]\nvocabulary = ["robot.toml"]\n'
    more = {"cell/parts/gripper.py": "OPEN = 1\n"}
    return write_project(folder, MISSION, TESTS, configuration=configuration, more=more)


@pytest.mark.parametrize(
    ("word", "nearest"),
    [
        ("revers", "reverse"),
        ("robott", "robot"),
        ("progam", "program"),
        ("misson.py", "mission.py"),
        ("misson.py:2", "mission.py"),
        ("misson*", ""),
        ("misson.*:2", ""),
        ("mission.py:20", "mission.py"),
        ("misson.py:run:arm.move_by#1:dx:reverse", "mission.py"),
        ("cel/", ""),
        ("", ""),
        ("9" * 5000, ""),
    ],
)
@pytest.mark.parametrize("option", ["only", "skip"])
def test_what_can_fit_nothing_is_reported_with_the_nearest(
    project: Path, option: str, word: str, nearest: str
) -> None:
    with pytest.raises(SelectionError, match=f"--{option}: no mutant matches") as error:
        refuse_typos(request_for(project, **{option: (word, "reverse")}))
    assert repr(nearest) in str(error.value) or not nearest


@pytest.mark.parametrize(
    "word",
    [
        "3", "2-4", "1,3-9", "reverse", "robot", "program", "oracle", "mission.py",
        "mission.py:2", "mission.py:1-3", "mission.py:2*", "cell", "cell/", "cell/parts",
        "gripper.py", "gripper.py:1",
        "…/gripper.py:1", "*.py", "*:revers",
        "mission.py:run:*",
        "mission.py:run:arm.move_by#1:dx:reverse", "miss?on.py:2",
    ],
)  # fmt: skip
def test_what_may_fit_is_left_to_the_plan(project: Path, word: str) -> None:
    refuse_typos(request_for(project, only=(word,), skip=(word,)))


@pytest.mark.parametrize("command", ["run", "list"])
def test_no_test_is_run_before_it_is_reported(
    project: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["-C", str(project), command, "--only", "revers"]) == 2
    assert "the nearest is 'reverse'" in capsys.readouterr().err
    assert not (project / "tests" / "was_run").exists()


@pytest.mark.parametrize(("word", "nearest"), [("foo", ""), ("rev", "reverse"), ("misson.py", "mission.py")])
def test_only_a_name_that_is_like_it_is_called_the_nearest(
    project: Path, word: str, nearest: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["-C", str(project), "list", "--only", word]) == 2
    hint = f"the nearest is {nearest!r}" if nearest else "`mutabot list` shows what there is"
    assert f"no mutant matches {word!r}; {hint}" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["run", "list"])
def test_long_numbers_are_of_no_mutant(
    project: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for word in ("9" * 5000, f"mission.py:{'9' * 5000}"):
        assert main(["-C", str(project), command, "--only", word]) == 2
        assert "99…'" in capsys.readouterr().err
