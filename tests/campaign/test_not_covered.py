"""What no test reaches stays in the score: files, functions and calls of operations, found by their names."""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from mutabot.campaign.checking import check, plan_only
from mutabot.campaign.run import run_campaign
from mutabot.errors import ExitCode, NothingToDoError
from mutabot.journal.journal import Journal
from mutabot.model import Verdict
from mutabot.report.document import document
from mutabot.results.gate import decide
from mutabot.results.results import Results, read_results
from tests.campaign.project import CONFIGURATION, REPLAY, Quiet, request_for, write_project
from tests.campaign.scripted import Script

PROGRAM = """
    def ahead(arm):
        arm.move_by(0.25)

    def back(arm):
        arm.move_by(-0.25)
        return open("log").read()
"""
AHEAD = """
    import mission
    import robot

    def test_ahead():
        arm = robot.Arm()
        mission.ahead(arm)
        assert arm.x == 0.25
"""
BACK = """
    def test_back():
        arm = robot.Arm()
        mission.back(arm)
"""
OTHER = """
    def flee(arm):
        arm.move_by(0.5)
"""


def project(folder: Path, tests: str = AHEAD) -> Path:
    write_project(folder, PROGRAM, tests)
    (folder / "other.py").write_text(dedent(OTHER), encoding="utf-8")
    text = dedent(CONFIGURATION).replace('["mission.py"]', '["mission.py", "other.py"]')
    (folder / "mutabot.toml").write_text(text, encoding="utf-8")
    return folder


def ran(folder: Path, **changes: Any) -> Results:
    with Journal.open(run_campaign(request_for(folder, **changes), Quiet())) as journal:
        return read_results(journal)


def score(results: Results) -> float:
    (group,) = results.groups
    return group.scores.mean or 0.0


def test_calls_that_no_test_reaches_are_not_covered_and_lower_the_score(
    tmp_path: Path, script: Script
) -> None:
    script.kill("move_by")
    results = ran(project(tmp_path))
    idle = {result.mutant.site.place for result in results.mutants if Verdict.NOT_COVERED in verdicts(result)}
    assert idle == {"mission.py:6:5", "other.py:3:5"}
    assert results.untested.text == "2 of 3 robot calls and 2 of 3 functions are reached by no test"
    assert decide(results, min_score=0.9).exit_code is ExitCode.SCORE_TOO_LOW


def test_a_function_without_statements_is_not_one_that_no_test_calls(tmp_path: Path) -> None:
    folder = project(tmp_path)
    stubs = """
        from typing import Protocol, overload

        class Arm(Protocol):
            def move_by(self, x: float) -> None:
                "Move."

        @overload
        def flee(arm: Arm) -> None: ...
        @overload
        def flee(arm: None) -> int: ...
        def flee(arm):
            return 1

        def quiet(arm):
            pass
    """
    (folder / "other.py").write_text(dedent(stubs), encoding="utf-8")
    report = check(request_for(folder), Quiet())
    assert report.data["untested"]["unreached_functions"] == ["mission.py:5 back", "other.py:12 flee"]


def verdicts(result: Any) -> set[Verdict]:
    return {outcome.verdict for outcome in result.outcomes}


@pytest.mark.parametrize("words", [("move_by",), ("ahead",), ()])
@pytest.mark.parametrize("family", ["robot", "conventional"])
def test_removing_a_test_never_raises_a_score(
    tmp_path: Path, script: Script, words: tuple[str, ...], family: str
) -> None:
    script.kill(*words)
    with_it = ran(project(tmp_path / "with", AHEAD + BACK), families=(family,))
    without = ran(project(tmp_path / "without"), families=(family,))
    assert score(without) <= score(with_it)
    assert len(without.mutants) >= len(with_it.mutants)


def test_a_mutant_keeps_its_id_and_its_outcome_gives_way_once_a_test_comes(
    tmp_path: Path, script: Script
) -> None:
    script.kill("move_by")
    folder = project(tmp_path)
    before = ran(folder)
    (folder / "tests" / "test_mission.py").write_text(dedent(AHEAD) + dedent(BACK), encoding="utf-8")
    after = ran(folder)
    assert {result.mutant.id for result in after.mutants} <= {result.mutant.id for result in before.mutants}
    ends = {result.mutant.id: verdicts(result) for result in after.mutants if ":back:" in result.mutant.id}
    assert set.union(*ends.values()) == {Verdict.KILLED}


def test_mutants_that_run_keep_their_numbers(tmp_path: Path, script: Script) -> None:
    alone = plan_only(request_for(write_project(tmp_path / "alone", PROGRAM, AHEAD)), Quiet()).mutants
    both = plan_only(request_for(project(tmp_path / "both")), Quiet()).mutants
    assert [mutant.id for mutant in both[: len(alone)]] == [mutant.id for mutant in alone]


def test_where_no_test_reaches_anything_there_is_no_campaign(tmp_path: Path, script: Script) -> None:
    tests = "def test_nothing():\n    import mission\n"
    with pytest.raises(NothingToDoError, match="no test reaches a call of the vocabulary's operations"):
        ran(project(tmp_path, tests))


def test_a_selection_may_be_of_what_no_test_reaches(tmp_path: Path, script: Script) -> None:
    results = ran(project(tmp_path), only=("other.py",))
    assert {result.mutant.site.span.file for result in results.mutants} == {"other.py"}
    assert score(results) == 0.0


def test_all_rounds_and_samples_know_of_them(tmp_path: Path, script: Script) -> None:
    results = ran(project(tmp_path), rounds=2)
    assert all(len(result.outcomes) == 2 for result in results.mutants)


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_the_text_of_a_real_project_is_enough(tmp_path: Path, engine: str) -> None:
    """``open`` is called where a test comes and where none does, and is no operation."""
    folder = project(tmp_path)
    results = ran(folder, engine=engine)
    told = document(results)["untested"]
    assert [call["place"] for call in told["unreached_calls"]] == ["mission.py:6:5", "other.py:3:5"]
    assert told["unreached_files"] == ["other.py"]
    assert told["unreached_functions"] == ["mission.py:5 back", "other.py:2 flee"]
    assert told["doubtful_calls"] == []
    assert json.dumps(told)
    lines = check(request_for(folder, engine=engine), Quiet()).lines
    assert f"untested  {results.untested.text}" in lines


def test_of_a_call_in_a_branch_and_of_one_that_is_no_operation(tmp_path: Path) -> None:
    program = """
        def go(arm, log, far=False):
            log.position()
            if far:
                arm.move_by(0.5)
                log.position()
            arm.move_by(0.25)
    """
    tests = """
        import mission
        import robot

        class Log:
            def position(self):
                return "none"

        def test_go():
            arm = robot.Arm()
            mission.go(arm, Log())
            assert arm.x == 0.25
    """
    results = ran(write_project(tmp_path, program, tests))
    assert [call.place for call in results.untested.unreached_calls] == ["mission.py:5:9"]
    assert [call.place for call in results.untested.doubtful_calls] == ["mission.py:6:9"]
    assert results.untested.text == "1 of 2 robot calls is reached by no test"


def test_a_statement_that_ends_with_a_call_is_not_this_call(tmp_path: Path) -> None:
    program = """
        from contextlib import ExitStack

        def go(arm, far=False):
            with ExitStack() as stack:
                stack.callback(arm.move_by, 0.25)
                arm.position() if not far else arm.move_by(0.5)
    """
    tests = """
        import mission
        import robot

        def test_go():
            arm = robot.Arm()
            mission.go(arm)
            assert arm.x == 0.25
    """
    results = ran(write_project(tmp_path, program, tests))
    assert [call.place for call in results.untested.unreached_calls] == ["mission.py:7:40"]


def test_a_file_that_no_test_imports_is_reported_whatever_it_is_written_in(tmp_path: Path) -> None:
    folder = project(tmp_path)
    text = f'# coding: latin-1\n"""Größe."""\n{dedent(OTHER)}'
    (folder / "other.py").write_text(text, encoding="latin-1")
    (folder / "old.py").write_text("print 'Python 2'\n", encoding="utf-8")
    toml = (folder / "mutabot.toml").read_text(encoding="utf-8")
    (folder / "mutabot.toml").write_text(toml.replace('"other.py"', '"other.py", "old.py"'), encoding="utf-8")
    untested = plan_only(request_for(folder), Quiet()).untested
    assert [call.place for call in untested.unreached_calls] == ["mission.py:6:5", "other.py:5:5"]
    assert untested.files == 3
    assert untested.unreached_files == ("old.py", "other.py")


LOADER = """
    import sys
    from importlib.machinery import PathFinder, SourceFileLoader

    class Templates(SourceFileLoader):
        def source_to_code(self, data, path, **more):
            return super().source_to_code(data.replace(b"STEP", b"(1 / 4)"), path, **more)

    class Finder:
        def find_spec(self, name, path=None, target=None):
            if name != "mission":
                return None
            spec = PathFinder.find_spec(name, path)
            spec.loader = Templates(name, spec.origin)
            return spec

    sys.meta_path.insert(0, Finder())
"""


def test_where_another_text_runs_it_is_not_said_that_no_test_reaches_a_call(tmp_path: Path) -> None:
    """Its calls stand elsewhere: it is not known which of the file's are reached."""
    program = "def ahead(arm):\n    arm.move_by(STEP)\n\ndef back(arm):\n    arm.move_by(-STEP)\n"
    folder = write_project(tmp_path, program, AHEAD, more={"conftest.py": LOADER})
    results = ran(folder)
    assert score(results) == 1.0
    assert results.untested.unreached_calls == ()
    assert {call.doubt for call in results.untested.doubtful_calls} == {
        "the code that runs is not compiled from this file's text"
    }


def test_a_call_that_is_none_of_the_commands_is_reached_all_the_same(tmp_path: Path) -> None:
    robot = """
        class Gripper:
            def __init__(self, name):
                self.name, self.told = name, []

            def close(self):
                self.told.append("close")

            def send(self, command):
                self.told.append(command)
    """
    mission = """
        def run(left, right):
            left.close()
            right.close()
            for word in ("lift 1", "status"):
                left.send(word)
            right.send("status" if right.told else "lift 2")

        def first(hand):
            hand.close()

        def second(hand):
            hand.close()
    """
    tests = """
        import mission
        from robot import Gripper

        def test_run():
            left, right = Gripper("left"), Gripper("right")
            mission.run(left, right)
            assert right.told == ["close", "status"]
            mission.first(left)
            mission.second(right)
    """
    vocabulary = """
        [[operation]]
        call = "robot:Gripper.close"
        when = { argument = "self.name", value = "left" }

        [[operation]]
        call = "robot:Gripper.send"
        message = "command"
        patterns = [{ text = "lift {height:g}", kind = "translation", axis = "z", unit = "cm", mode = "by" }]
    """
    folder = write_project(tmp_path, mission, tests, robot=robot, vocabulary=vocabulary)
    untested = check(request_for(folder), Quiet()).data["untested"]
    assert (untested["unreached_calls"], untested["doubtful_calls"]) == ([], [])


def test_a_call_of_what_wraps_an_operation_is_reached_and_the_call_inside_is_its_site(tmp_path: Path) -> None:
    program = """
        import functools
        from robot import Arm

        def logged(function):
            @functools.wraps(function)
            def call(*given):
                return function(*given)
            return call

        class Logged:
            def __init__(self, arm):
                self.position, self.move_by = logged(arm.position), logged(arm.move_by)

        class Sub(Arm):
            position, move_by = logged(Arm.position), logged(Arm.move_by)

        def go(arm):
            arm.move_by(0.5)
            return arm.position()

        def again(arm):
            arm.move_by(0.5)
            return arm.position()
    """
    tests = """
        import mission
        import robot

        def test_go():
            assert mission.go(mission.Logged(robot.Arm())) == 0.5
            assert mission.again(mission.Sub()) == 0.5
    """
    results = ran(write_project(tmp_path, program, tests))
    assert results.untested.unreached_calls == ()
    assert {result.mutant.site.text for result in results.mutants} == {"function"}
    assert score(results) == 1.0
