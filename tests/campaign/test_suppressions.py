"""Accepted survivors and excluded mutants in campaigns: files, comments, what has no effect, and reuse."""

from __future__ import annotations

import datetime
import json
from pathlib import Path

import pytest

from mutabot.campaign.run import run_campaign
from mutabot.cli.app import main
from mutabot.config.suppressions import FILE, add_acceptances
from mutabot.errors import ConfigurationError, ExitCode
from mutabot.results.results import Results
from tests.campaign.project import Quiet, request_for, write_project
from tests.campaign.scripted import Script

MISSION = """
    def go(arm):
        arm.move_by(0.1)
        arm.move_by(0.2)
        return arm.position()
"""
TESTS = """
    from robot import Arm
    import mission

    def test_goes():
        assert mission.go(Arm()) > 0.2
"""
FIRST, SECOND = "mission.py:go:arm.move_by#1:call:skip", "mission.py:go:arm.move_by#2:call:skip"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    return write_project(tmp_path, MISSION, TESTS)


def campaign(project: Path, progress: Quiet | None = None, **changes: object) -> Results:
    return Results.read(run_campaign(request_for(project, **changes), progress or Quiet()))


def accept(project: Path, *tables: str) -> None:
    (project / FILE).write_text("\n".join(tables), encoding="utf-8")


def accepted(results: Results) -> dict[str, str]:
    return {
        result.mutant.id: result.acceptance.why
        for result in results.accepted
        if result.acceptance is not None
    }


def entry(action: str = "accept", **keys: str) -> str:
    return "\n".join([f"[[{action}]]", *(f"{key} = {json.dumps(text)}" for key, text in keys.items()), ""])


def test_an_accepted_survivor_leaves_list_and_score_and_keeps_its_verdict(
    project: Path, script: Script
) -> None:
    script.kill("reverse")
    before = campaign(project)
    accept(project, entry(id=FIRST, line="arm.move_by(0.1)", why="it is repeated"))
    after = campaign(project)
    assert accepted(after) == {FIRST: "it is repeated"}
    assert {survivor.mutant.id for survivor in before.survivors} - {
        survivor.mutant.id for survivor in after.survivors
    } == {FIRST}
    assert [result.rounds[0].verdict for result in after.mutants if result.rounds[0]] == [
        result.rounds[0].verdict for result in before.mutants if result.rounds[0]
    ]
    assert after.all.total.valid == before.all.total.valid - 1
    assert after.all.total.killed == before.all.total.killed
    assert [group.scores.accepted for group in after.groups] == [1]


def test_accepting_runs_nothing_again(project: Path, script: Script) -> None:
    campaign(project)
    script.tasks.clear()
    accept(project, entry(operator="skip", why="any"))
    assert len(campaign(project).accepted) == 2
    assert script.tasks == []


def test_a_pattern_names_file_operator_and_text_of_the_line(project: Path, script: Script) -> None:
    accept(project, entry(file="*.py", operator="skip", line="arm.move_by(*2)", why="slow"))
    assert accepted(campaign(project)) == {SECOND: "slow"}


@pytest.mark.parametrize(
    "program",
    [
        "def go(arm):\n    arm.move_by(0.1)  # mutabot: accept skip, repeat: slow\n    arm.move_by(0.2)\n"
        "    return arm.position()\n",
        "def go(arm):\n    # mutabot: accept skip, repeat: slow\n    # it is\n\n    arm.move_by(0.1)\n"
        "    arm.move_by(0.2)\n    return arm.position()\n",
    ],
    ids=["behind the call", "above it"],
)
def test_a_comment_accepts_its_operators_on_its_line(project: Path, script: Script, program: str) -> None:
    (project / "mission.py").write_text(program)
    found = campaign(project)
    assert accepted(found) == {FIRST: "slow", FIRST.replace("skip", "repeat"): "slow"}
    assert all(result.acceptance and result.acceptance.in_source for result in found.accepted)


def test_excluded_mutants_are_left_out_with_the_reason_and_numbers_stay(
    project: Path, script: Script
) -> None:
    before = campaign(project)
    accept(project, entry("exclude", operator="skip", file="mission.py", why="no time"))
    after = campaign(project)
    assert {omission.id: omission.reason for omission in after.left_out}[FIRST] == "excluded: no time"
    rest = {
        result.mutant.id: result.mutant.number
        for result in before.mutants
        if result.mutant.operator != "skip"
    }
    assert {result.mutant.id: result.mutant.number for result in after.mutants} == rest


def test_a_line_that_has_changed_is_named_and_its_survivor_is_not_accepted(
    project: Path, script: Script
) -> None:
    accept(project, entry(id=FIRST, line="arm.move_by(0.15)", why="it is repeated"))
    progress = Quiet()
    found = campaign(project, progress)
    text = f"{FILE}:1: the line of {FIRST} has changed from 'arm.move_by(0.15)' to 'arm.move_by(0.1)'"
    assert accepted(found) == {}
    assert [line for line in found.accepting.unmatched if line.startswith(text)]
    assert [line for line in progress.lines if line.startswith(text)]


def test_a_call_that_is_gone_is_named(project: Path, script: Script) -> None:
    accept(project, entry(id="mission.py:go:arm.open#1:call:skip", why="gone"))
    assert campaign(project).accepting.unmatched == (
        f"{FILE}:1: no mutant is mission.py:go:arm.open#1:call:skip: the decision has no effect",
    )


def test_decisions_about_families_that_are_not_run_are_not_said_to_fit_nothing(
    project: Path, script: Script
) -> None:
    accept(project, entry(operator="offset", why="graded"), entry(operator="skip", why="any"))
    assert campaign(project).accepting.unmatched == ()


def test_what_is_killed_by_now_is_named_unless_a_mutant_of_the_same_decision_survives(
    project: Path, script: Script
) -> None:
    script.kill(FIRST, "repeat")
    accept(project, entry(operator="skip", why="one survives"), entry(operator="repeat", why="none does"))
    found = campaign(project)
    killed = [str(result.mutant.number) for result in found.mutants if result.mutant.operator == "repeat"]
    assert found.needlessly_accepted == [
        f"{FILE}:5: mutants {', '.join(killed)} are killed now, so there is nothing to accept"
    ]


def test_a_survivor_in_one_of_several_rounds_is_accepted_in_all(project: Path, script: Script) -> None:
    script.mutated = lambda run: {} if run.round else {"outcome": "failed", "by": "check"}
    accept(project, entry(id=FIRST, why="by chance"))
    found = campaign(project, rounds=2)
    assert list(accepted(found)) == [FIRST]
    assert [end.valid for end in found.all.rounds] == [len(found.mutants) - 1] * 2


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (entry(id=FIRST, why="  "), "why: is empty"),
        (entry(id=FIRST), "'why' is missing"),
        (entry(why="none"), "names no mutant"),
        (entry(operator="skpi", why="typo"), "'skip'"),
        (entry(operator="skip", becuase="x", why="x"), "becuase"),
        ("[[acept]]\nwhy = 'x'\n", "'accept'"),
    ],
)
def test_a_mistake_in_the_file_is_reported_before_anything_is_run(
    project: Path, script: Script, text: str, words: str
) -> None:
    accept(project, text)
    with pytest.raises(ConfigurationError, match=words) as raised:
        campaign(project)
    assert str(raised.value).startswith(FILE)
    assert script.tasks == []


@pytest.mark.parametrize(
    ("comment", "words"),
    [
        ("acept skip: why", "'acept'"),
        ("accept skip", "no reason"),
        ("accept: why", "names no operator"),
        ("exclude skpi: why", "'skip'"),
    ],
)
def test_a_mistake_in_a_comment_is_reported_before_anything_is_run(
    project: Path, script: Script, comment: str, words: str
) -> None:
    (project / "mission.py").write_text(f"def go(arm):\n    arm.move_by(0.1)  # mutabot: {comment}\n")
    with pytest.raises(ConfigurationError, match=words) as raised:
        campaign(project)
    assert str(raised.value).startswith("mission.py:2")
    assert script.tasks == []


def test_texts_that_look_like_comments_mean_nothing(project: Path, script: Script) -> None:
    (project / "mission.py").write_text(
        'def go(arm):\n    """Write # mutabot: acept skip"""\n    arm.move_by(0.1)  # see mutabot: the tool\n'
    )
    assert accepted(campaign(project)) == {}


# The command


def run(project: Path, *arguments: str) -> int:
    return main(["-C", str(project), *arguments])


def test_the_command_accepts_several_numbers_at_once_and_none_if_one_of_them_is_no_survivor(
    project: Path, script: Script, capsys: pytest.CaptureFixture[str]
) -> None:
    script.kill(FIRST, "repeat")
    found = campaign(project).mutants
    survivors = [result.mutant.number for result in found if result.is_survivor]
    first, *_, last = survivors
    numbers = {result.mutant.number: result for result in found}
    between = [number for number in range(first, last + 1) if not numbers[number].is_survivor]
    assert between
    assert run(project, "accept", f"{first}-{last}", "--why", "all") == ExitCode.USAGE
    assert f"mutant {between[0]} is not a survivor" in capsys.readouterr().err
    assert not (project / FILE).exists()
    assert run(project, "accept", ",".join(map(str, survivors)), "--why", "all") == ExitCode.FINE
    assert len(accepted(campaign(project))) == len(survivors)


def test_the_command_writes_reason_line_and_date_and_applies_them_at_once(
    project: Path, script: Script, capsys: pytest.CaptureFixture[str]
) -> None:
    number = next(result.mutant.number for result in campaign(project).mutants if result.mutant.id == FIRST)
    why = 'it is "repeated" \\ later'
    assert run(project, "accept", str(number), "--why", why) == ExitCode.FINE
    capsys.readouterr()
    assert run(project, "accept", "--json") == ExitCode.FINE
    (found,) = json.loads(capsys.readouterr().out)["survivors"]
    today = datetime.date.today().isoformat()
    assert found == {
        "number": number, "id": FIRST, "why": why, "source": f"{FILE}:4", "date": today, "in_source": False,
    }  # fmt: skip
    assert 'line = "arm.move_by(0.1)"' in (project / FILE).read_text(encoding="utf-8")
    assert accepted(campaign(project)) == {FIRST: why}


def test_what_a_user_wrote_in_the_file_stays(project: Path) -> None:
    accept(project, "# ours", entry("exclude", operator="skip", why="x").rstrip())
    before = (project / FILE).read_text(encoding="utf-8")
    add_acceptances(project, [(FIRST, "")], "why", datetime.date(2026, 1, 31))
    after = (project / FILE).read_text(encoding="utf-8")
    assert after.startswith(before)
    assert after.endswith(f'[[accept]]\nid = "{FIRST}"\nwhy = "why"\ndate = 2026-01-31\n')


def test_the_file_is_applied_to_the_last_campaign_without_a_run(
    project: Path, script: Script, capsys: pytest.CaptureFixture[str]
) -> None:
    path = run_campaign(request_for(project), Quiet())
    accept(project, entry(operator="skip", why="any"))
    script.tasks.clear()
    assert run(project, "accept") == ExitCode.FINE
    assert len(Results.read(path).accepted) == 2
    assert script.tasks == []
    (project / FILE).unlink()
    assert run(project, "accept") == ExitCode.FINE
    assert Results.read(path).accepted == []
    assert capsys.readouterr().out.endswith("No survivor is accepted\n")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["1"], "say why"),
        (["--why", "x"], "needs a mutant"),
        (["99", "--why", "x"], "the last campaign has no mutant 99"),
        (["reverse", "--why", "x"], "is not a survivor (killed)"),
    ],
)
def test_what_cannot_be_accepted_is_refused_and_nothing_is_written(
    project: Path, script: Script, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    script.kill("reverse")
    run_campaign(request_for(project, only=(FIRST, FIRST.replace("call:skip", "dx:reverse"))), Quiet())
    assert run(project, "accept", *arguments) == ExitCode.USAGE
    assert words in capsys.readouterr().err
    assert not (project / FILE).exists()


def test_a_mutant_is_not_accepted_twice(
    project: Path, script: Script, capsys: pytest.CaptureFixture[str]
) -> None:
    run_campaign(request_for(project, only=(FIRST,)), Quiet())
    assert run(project, "accept", FIRST, "--why", "x") == 0
    assert run(project, "accept", FIRST, "--why", "y") == ExitCode.USAGE
    assert "was already accepted on " in capsys.readouterr().err


def test_a_file_with_a_mistake_is_not_added_to(
    project: Path, script: Script, capsys: pytest.CaptureFixture[str]
) -> None:
    run_campaign(request_for(project, only=(FIRST,)), Quiet())
    accept(project, "[[accept")
    assert run(project, "accept", FIRST, "--why", "x") == ExitCode.USAGE
    assert capsys.readouterr().err.startswith(f"mutabot: {FILE}:1: is not valid TOML")
    assert (project / FILE).read_text(encoding="utf-8") == "[[accept"
