"""A mutant has one number, whatever is selected; and mutants of the text alone need no vocabulary."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mutabot.cli.app import main
from mutabot.errors import ExitCode
from tests.campaign.project import write_project

MISSION = """
    def run(arm):
        arm.move_by(0.25)
        arm.move_by(-0.5)
        return 2 + 3
"""
TESTS = """
    import mission
    from robot import Arm

    def test_it_is_where_it_should_be():
        arm = Arm()
        assert mission.run(arm) == 5
        assert arm.x == -0.25
"""


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, int]:
    """Ids and numbers of the mutants that a command prints."""
    capsys.readouterr()
    assert main([*words, "--json"]) == ExitCode.FINE
    return {mutant["id"]: mutant["number"] for mutant in json.loads(capsys.readouterr().out)["mutants"]}


@pytest.mark.whole
def test_list_and_run_number_alike_with_and_without_a_selection(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(write_project(tmp_path, MISSION, TESTS))
    whole = printed(capsys, "list")
    chosen = [*whole][3:0:-2]
    Path("chosen.txt").write_text("\n".join(chosen))
    wanted = {mutant: whole[mutant] for mutant in whole if mutant in chosen}
    assert printed(capsys, "list", "--only", "@chosen.txt") == wanted
    assert printed(capsys, "run", "--only", "@chosen.txt") == wanted
    assert printed(capsys, "results") == wanted
    assert printed(capsys, "run") == whole
    shown = printed(capsys, "run", "--only", "@chosen.txt")
    assert {mutant: shown[mutant] for mutant in wanted} == wanted
    assert printed(capsys, "list", "--only", "2,4") == wanted


@pytest.mark.needs("source")
@pytest.mark.whole
@pytest.mark.parametrize(
    ("vocabulary", "why"),
    [
        ("", "empty"),
        ("vocabulary = []", "empty"),
        ('vocabulary = ["robot.toml"]', "robot.toml: describes nothing"),
    ],
)
def test_mutants_of_the_text_alone_need_no_vocabulary(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], vocabulary: str, why: str
) -> None:
    configuration = f'program = ["mission.py"]\n{vocabulary}\npytest_args = ["-o", "pythonpath=."]\n'
    write_project(tmp_path, MISSION, TESTS, configuration=configuration, vocabulary="")
    project = ["-C", str(tmp_path)]
    found = printed(capsys, *project, "run", "--family", "conventional")
    assert found
    assert main([*project, "run", "--family", "conventional", "--family", "robot"]) == ExitCode.USAGE
    err = capsys.readouterr().err
    assert "vocabulary" in err
    assert why in err
    assert main([*project, "run"]) == ExitCode.USAGE
    (tmp_path / "mutabot.toml").write_text(f'families = ["conventional", "text"]\n{configuration}')
    assert found.keys() <= printed(capsys, *project, "run").keys()
    assert main([*project, "replay", next(iter(found))]) == ExitCode.FINE
