"""Mutants of the program text in campaigns: the same door, engines, judge and journal as mutants of calls."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest

from mutabot.campaign.checking import PlannedCampaign, check, plan_only
from mutabot.campaign.run import run_campaign
from mutabot.campaign.verdict import Run, _ruling
from mutabot.errors import NothingToDoError
from mutabot.model import By, Mutant, Outcome, Role, Site, Span, Verdict
from mutabot.model.events import TestEnd
from mutabot.model.outcome_text import same_end
from tests.campaign.project import (
    CONFIGURATION,
    REPLAY,
    ROBOT,
    VOCABULARY,
    Quiet,
    fingerprint,
    no_private_files,
    request_for,
    run,
    write_project,
)
from tests.campaign.scripted import CHECKED, Script

pytestmark = pytest.mark.needs("source")

MISSION = """
    import robot

    STEP = 0.4
    LIMIT = 5

    def right(arm):
        arm.move_by(STEP / 2)
        arm.move_by(0.2)
        return arm.position()

    def far(arm, factor):
        arm.move_by(0.5 * factor)

    def careful(arm):
        try:
            arm.move_by(0.3)
        except robot.Refused:
            return False
        return True

    def count(items):
        total = 0
        while total < len(items):
            total += 1
        return total

    def unused(x):
        return x > 1
"""
TESTS = """
    import mission
    import robot

    def test_right():
        arm = robot.Arm()
        assert abs(mission.right(arm) - 0.4) < 0.05
        assert mission.LIMIT > 2

    def test_far():
        arm = robot.Arm()
        mission.far(arm, 1.0)
        assert arm.x > 0.1

    def test_careful():
        assert mission.careful(robot.Arm())

    def test_count():
        assert mission.count("abc") == 3
"""

#: loops without an end are ended by their processor time
QUICK = 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\npytest_args = ["-o", "pythonpath=."]\n'


#: some of each kind, since every one of them is run in a process of its own as well
SOME = (
    "mission.py:right:arm.move_by#1:dx:reverse",
    "mission.py:right:STEP / 2#1:*",
    "mission.py:far:0.5 * factor#1:AOR*",
    "mission.py:far:arm.move_by(0.5 * factor)#1:BSR",
    "mission.py:careful:*",
    "mission.py:count:total += 1#1:ASR=sub",
    "mission.py:count:total < len(items)#1:ROR=ne",
    "mission.py:unused:return x > 1#1:BSR",
    "mission.py:<module>:0.4#1:UOI=neg",
    "mission.py:<module>:STEP = 0.4#1:BSR",
)


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("conventional")
    return write_project(folder, MISSION, TESTS, configuration=QUICK + "timeout_seconds = 2\n")


#: by one engine in the short run, by both in the long one; that they agree on every mutant is for the corpus
ENGINES = pytest.mark.parametrize("engine", ["auto", REPLAY])


@pytest.fixture(scope="module")
def ends(project: Path) -> dict[str, Outcome]:
    """All outcomes by mutant: forks, and processes of their own where these cannot be."""
    before = fingerprint(project)
    found = run(project, engine="auto", families=("robot", "conventional"), only=SOME, fresh=True)
    assert fingerprint(project) == before
    return found


def end(ends: dict[str, Outcome], mutant: str) -> Outcome:
    return ends[f"mission.py:{mutant}"]


@pytest.mark.whole
def test_both_engines_agree_on_every_mutant(project: Path, ends: dict[str, Outcome]) -> None:
    replayed = run(project, engine="replay", families=("robot", "conventional"), only=SOME, fresh=True)
    assert ends.keys() == replayed.keys()
    different = {
        mutant: (first, replayed[mutant])
        for mutant, first in ends.items()
        if not _is_same(first, replayed[mutant])
    }
    assert different == {}


def _is_same(first: Outcome, second: Outcome) -> bool:
    if first.verdict is second.verdict is Verdict.TIMEOUT:  # its limit follows from its campaign's baseline
        return first.test == second.test
    return same_end(first, second) and _more(first) == _more(second)


def _more(outcome: Outcome) -> tuple[Any, ...]:
    return outcome.acted, outcome.commands, outcome.kills, outcome.example, outcome.indistinguishable


def test_forks_are_what_runs_mutants_that_act_in_a_test_or_before_any(ends: dict[str, Outcome]) -> None:
    assert any(":<module>:" in mutant for mutant in ends)
    # on a busy machine, what ran out of time is run once more by itself
    others = {
        mutant: outcome for mutant, outcome in ends.items() if outcome.engine != "fork" and outcome.tests
    }
    assert {outcome.verdict for outcome in others.values()} <= {Verdict.TIMEOUT}


def test_a_check_kills(ends: dict[str, Outcome]) -> None:
    found = end(ends, "right:STEP / 2#1:AOR=mul")
    assert (found.verdict, found.by, found.test) == (
        Verdict.KILLED,
        By.CHECK,
        "tests/test_mission.py::test_right",
    )
    assert found.example == (0.2, 0.8)
    assert found.commands == 2
    assert [kill.test for kill in found.kills] == ["tests/test_mission.py::test_right"]
    assert not found.complete


def test_a_bomb_kills_by_exception_before_any_command(ends: dict[str, Outcome]) -> None:
    found = end(ends, "far:arm.move_by(0.5 * factor)#1:BSR")
    assert (found.verdict, found.by, found.commands) == (Verdict.KILLED, By.EXCEPTION, 0)
    assert found.exception == "mutabot.runtime.alternatives:Bomb"


def test_what_nothing_notices_survives(ends: dict[str, Outcome]) -> None:
    found = end(ends, "far:0.5 * factor#1:AOR=rightOp")
    assert (found.verdict, found.example, found.kills) == (Verdict.SURVIVED, (0.5, 1.0), ())


def test_an_alternative_with_the_same_value_has_no_effect(ends: dict[str, Outcome]) -> None:
    found = end(ends, "far:0.5 * factor#1:AOR=pow")
    assert (found.verdict, found.hits, found.acted) == (Verdict.NO_EFFECT, 1, 0)


def test_a_mutant_without_effect_needs_no_fork_and_one_with_a_late_effect_forks_late(
    tmp_path: Path,
) -> None:
    mission = """
        def way(arm):
            for step in (0.1, 0.2, -0.1, 0.2):
                arm.move_by(abs(step))
                arm.move_by(step)
    """
    tests = """
        import mission
        import robot

        def test_way():
            arm = robot.Arm(-0.9)
            mission.way(arm)
            assert arm.x < 1.0
    """
    robot = dedent(ROBOT).replace("self.x += dx", "self.x += dx\n        self.tick()")
    robot += "\n    time = 0.0\n\n    def tick(self):\n        self.time += 1.0\n        return self.time\n"
    vocabulary = 'clock = { tick = "robot:Arm.tick", unit = "s" }\n' + dedent(VOCABULARY)
    project = write_project(tmp_path, mission, tests, robot=robot, vocabulary=vocabulary)
    only = ("mission.py:way:step*",)
    ends = run(project, engine="fork", families=("conventional",), only=only)
    zero, late = (f"mission.py:way:step#2:ABS={variant}" for variant in ("failOnZero", "abs"))
    idle, acting = ends[zero], ends[late]
    assert (idle.verdict, idle.hits, idle.acted, idle.engine) == (Verdict.NO_EFFECT, 4, 0, "fork")
    assert idle.shared == idle.simulated == 7.0  # eight ticks; the fork parent ran them all
    assert (acting.hits, acting.acted, acting.example) == (4, 1, (-0.1, 0.1))
    early = ends["mission.py:way:step#2:UOI=neg"]
    # the former differs at the first evaluation, before any tick; the latter after five of them
    assert (early.shared, acting.shared) == (0.0, 4.0)


@pytest.mark.whole
def test_a_difference_in_a_process_that_the_test_forked_is_not_overlooked(tmp_path: Path) -> None:
    mission = "def size(x):\n    return x\n"
    tests = """
        import multiprocessing

        import mission

        def test_size():
            assert mission.size(1) == 1
            with multiprocessing.get_context("fork").Pool(1) as pool:
                assert pool.apply(mission.size, (-1,)) == -1
    """
    project = write_project(tmp_path, mission, tests)
    mutant = "mission.py:size:x#1:ABS=abs"
    found = run(project, engine="auto", families=("conventional",), only=(mutant,))[mutant]
    assert found.verdict is Verdict.KILLED


def test_a_loop_without_end_times_out(ends: dict[str, Outcome]) -> None:
    found = end(ends, "count:total += 1#1:ASR=sub")
    assert found.verdict is Verdict.TIMEOUT
    assert "processor time" in (found.message or "")


def test_a_refusal_that_ends_the_test_stands_outside(ends: dict[str, Outcome]) -> None:
    found = end(ends, "far:0.5 * factor#1:AOR=add")
    assert (found.verdict, found.exception) == (Verdict.REFUSED, "robot:Refused")
    assert found.commands == 1


@ENGINES
def test_a_refusal_that_the_program_handles_is_no_refusal(tmp_path: Path, engine: str) -> None:
    mission = """
        import robot

        def careful(arm):
            try:
                arm.move_by(0.5 + 0.3)
            except robot.Refused:
                return False
            return True
    """
    tests = """
        import mission
        import robot

        def test_it():
            assert mission.careful(robot.Arm(0.1)) in (True, False)

        def test_sure():
            assert mission.careful(robot.Arm(-0.5))
    """
    project = write_project(tmp_path, mission, tests)
    found = run(project, engine=engine, families=("conventional",), only=("UOI",))
    assert found["mission.py:careful:0.3#1:UOI=neg"].verdict is Verdict.SURVIVED
    negative = found["mission.py:careful:0.5 + 0.3#1:UOI=neg"]
    assert (negative.verdict, negative.by) == (Verdict.KILLED, By.CHECK)
    assert negative.test == "tests/test_mission.py::test_sure"


def test_places_that_no_test_reaches_are_not_covered(ends: dict[str, Outcome]) -> None:
    assert end(ends, "unused:return x > 1#1:BSR").verdict is Verdict.NOT_COVERED


def test_values_computed_at_import_are_mutated_in_processes_of_their_own(
    ends: dict[str, Outcome],
) -> None:
    found = end(ends, "<module>:0.4#1:UOI=neg")
    assert (found.verdict, found.by, found.test) == (
        Verdict.KILLED,
        By.CHECK,
        "tests/test_mission.py::test_right",
    )
    assert found.acted >= 1


def test_a_program_that_cannot_be_imported_kills_by_exception(ends: dict[str, Outcome]) -> None:
    found = end(ends, "<module>:STEP = 0.4#1:BSR")
    assert (found.verdict, found.by) == (Verdict.KILLED, By.EXCEPTION)
    assert found.exception == "mutabot.runtime.alternatives:Bomb"
    assert found.commands == 0


@pytest.mark.usefixtures("script")
def test_numbers_of_robot_mutants_do_not_change_when_families_are_added(project: Path) -> None:
    alone = plan_only(request_for(project), Quiet()).mutants
    together = plan_only(request_for(project, families=("robot", "conventional", "text")), Quiet()).mutants
    assert together[: len(alone)] == alone
    assert [mutant.number for mutant in together] == list(range(1, len(together) + 1))
    assert [mutant.family for mutant in together] == sorted(
        (mutant.family for mutant in together), key=("robot", "conventional", "text").index
    )


@pytest.mark.usefixtures("script")
def test_families_operators_and_ids_select(project: Path) -> None:
    def chosen(**selection: Any) -> set[str]:
        mutants = plan_only(
            request_for(project, families=("robot", "conventional"), **selection), Quiet()
        ).mutants
        return {mutant.id for mutant in mutants}

    assert all(":BSR" in mutant for mutant in chosen(only=("BSR",)))
    assert chosen(only=("conventional",)).isdisjoint(chosen(only=("robot",)))
    wild = "mission.py:far:0.5 * factor#1:AOR=add"
    assert chosen(only=(wild,)) == {wild}
    file = project / "chosen.txt"
    file.write_text(f"# some\n{wild}\n", encoding="utf-8")
    assert chosen(only=(f"@{file}",)) == {wild}
    file.unlink()


@pytest.mark.usefixtures("script")
def test_what_still_holds_is_reused_also_after_another_family_ran(tmp_path: Path) -> None:
    project = write_project(tmp_path, "def near(x):\n    return x < 0.5\n", SMALL)
    only = ("BSR",)
    first = run(project, families=("conventional",), only=only)
    other = Quiet()
    with pytest.raises(NothingToDoError):  # there is no call of the robot
        run_campaign(request_for(project, families=("robot",)), other)
    again = Quiet()
    run_campaign(request_for(project, families=("conventional",), only=only), again)
    assert any(line.startswith(f"reused all {len(first)} outcomes") for line in again.lines)
    every = Quiet()
    run_campaign(request_for(project, families=("conventional",), only=only, every_test=True), every)
    assert any("every test is new" in line for line in every.lines)


SMALL = """
    import mission

    def test_near():
        assert mission.near(0.1)

    def test_far():
        assert not mission.near(0.9)
"""


@pytest.mark.whole
@ENGINES
def test_every_test_that_notices_is_known_when_asked_for(tmp_path: Path, engine: str) -> None:
    project = write_project(tmp_path, "def near(x):\n    return x < 0.5\n", SMALL)
    found = run(project, engine=engine, families=("conventional",), only=("ROR", "UOI"), every_test=True)
    inverted = found["mission.py:near:x < 0.5#1:UOI=not"]
    assert inverted.complete
    assert [kill.test.rpartition("::")[2] for kill in inverted.kills] == ["test_near", "test_far"]
    assert {kill.by for kill in inverted.kills} == {By.CHECK}
    assert inverted.test == inverted.kills[0].test
    outcome = found["mission.py:near:x < 0.5#1:ROR=trueOp"]
    assert [kill.test.rpartition("::")[2] for kill in outcome.kills] == ["test_far"]


@ENGINES
def test_controls_run_in_the_program_text_as_well(project: Path, engine: str) -> None:
    request = request_for(project, families=("conventional",), only=("mission.py:right:*",), engine=engine)
    assert check(request, Quiet()).data["controls"] >= 2


@pytest.mark.skipif(no_private_files() is not None, reason="files cannot be changed for one process alone")
def test_a_file_that_a_test_runs_by_itself_is_changed_for_it(tmp_path: Path) -> None:
    tests = """
        from pathlib import Path

        def test_near():
            space = {}
            exec(Path("mission.py").read_text(), space)
            assert space["near"](0.1)
    """
    project = write_project(tmp_path, "def near(x):\n    return x < 0.5\n", tests)
    found = run(project, families=("conventional",), only=("*ROR=trueOp", "*ROR=falseOp"), engine="auto")
    verdicts = {name.rpartition("=")[2]: (outcome.verdict, outcome.engine) for name, outcome in found.items()}
    assert verdicts == {"trueOp": (Verdict.SURVIVED, "replay"), "falseOp": (Verdict.KILLED, "replay")}


def test_a_file_that_no_test_imports_has_mutants_that_are_not_covered(tmp_path: Path) -> None:
    tests = "def test_nothing():\n    pass\n"
    project = write_project(tmp_path, "def near(x):\n    return x < 0.5\n", tests)
    with pytest.raises(NothingToDoError, match=r"no test reaches any of the \d+ mutants of mission.py"):
        run(project, families=("conventional",))
    mutants = plan_with_robot(project).mutants
    assert any(mutant.site.span.file == "mission.py" for mutant in mutants)


def plan_with_robot(project: Path) -> PlannedCampaign:
    """The plan of a program in which at least one file is imported."""
    (project / "other.py").write_text("def one():\n    return 1\n", encoding="utf-8")
    (project / "tests" / "test_other.py").write_text(
        "import other\n\ndef test_one():\n    assert other.one() == 1\n", encoding="utf-8"
    )
    text = CONFIGURATION.replace('["mission.py"]', '["mission.py", "other.py"]')
    (project / "mutabot.toml").write_text(dedent(text), encoding="utf-8")
    return plan_only(request_for(project, families=("conventional",)), Quiet())


def test_a_file_that_was_imported_too_early_is_left_out_with_the_reason(tmp_path: Path) -> None:
    early = {"early.py": "import mission\n"}
    configuration = QUICK.replace('"-o"', '"-p", "early", "-o"')
    project = write_project(
        tmp_path, "def near(x):\n    return x < 0.5\n", SMALL, configuration=configuration, more=early
    )
    (project / "pytest.ini").write_text("[pytest]\npythonpath = .\n", encoding="utf-8")
    with pytest.raises(NothingToDoError, match="imported before"):
        run(project, families=("conventional",))


def test_a_mutant_that_was_not_in_the_program_is_an_error() -> None:
    mutant = Mutant(
        1, "conventional", "BSR", Site(Span("m.py", 1, 0, 1, 1, "f"), "x", 1, Role.PROGRAM), "", *NONE
    )
    ends = [TestEnd("t.py::test", "passed")]
    run = Run(mutant, 0, ("t.py::test",), ends, problem="m.py: it has changed since its mutants were made")
    assert _ruling(run, usual=0) == (Verdict.ERROR, None, "m.py: it has changed since its mutants were made")


NONE = (None, None, "", "")


def test_a_text_that_is_no_program_is_invalid(tmp_path: Path) -> None:
    mission = 'def three():\n    return eval("1+2")\n'
    tests = "import mission\n\ndef test_it():\n    assert mission.three() == 3\n"
    project = write_project(tmp_path, mission, tests)
    found = run(project, families=("text",), only=("drop-character",))
    last = found['mission.py:three:"1+2"#1:drop-character=3']
    assert last.verdict is Verdict.INVALID
    assert last.exception == "builtins:SyntaxError"
    assert found['mission.py:three:"1+2"#1:drop-character=1'].verdict is Verdict.KILLED


@ENGINES
def test_a_command_that_the_vocabulary_does_not_know_is_invalid(tmp_path: Path, engine: str) -> None:
    robot = """
        class Refused(Exception):
            pass

        def send(text):
            word, _, number = text.partition("/")
            if word != "lift" or not number.isdigit() or int(number) > 5:
                raise Refused(text)
    """
    vocabulary = """
        refusals = ["robot:Refused"]

        [[operation]]
        call = "robot:send"
        message = "text"
        patterns = [
          { text = "lift/{height:g}", kind = "translation", axis = "z", unit = "cm", mode = "by" },
        ]
    """
    mission = 'import robot\n\ndef run():\n    robot.send("lift/5")\n'
    tests = "import mission\n\ndef test_it():\n    mission.run()\n"
    project = write_project(tmp_path, mission, tests, robot=robot, vocabulary=vocabulary)
    ends = run(project, engine=engine, families=("text",), only=("*swap*", "*replace*"))
    found = {mutant.rpartition(":")[2]: outcome.verdict for mutant, outcome in ends.items()}
    assert set(found.values()) == {Verdict.INVALID, Verdict.REFUSED}
    assert found["swap-characters=2"] is Verdict.INVALID
    assert found["replace-character=6"] is Verdict.REFUSED  # lift/6: a command, and too high


@pytest.mark.parametrize("rounds", [1, 2])
def test_text_whose_tests_fail_while_it_is_looked_at_is_named_and_not_mutated(
    tmp_path: Path, script: Script, rounds: int
) -> None:
    """As where an import hook counts what stands in the program."""

    def original(run: object) -> dict[str, Any]:
        found = script.tasks[-1].job.instrumentation
        return dict(CHECKED) if found is not None and found.record else {}

    script.original = original
    script.mutated = lambda run: CHECKED
    write_project(
        tmp_path,
        MISSION,
        "import mission\nfrom robot import Arm\n\ndef test_right():\n    mission.right(Arm())\n",
    )
    planned = plan_only(request_for(tmp_path, families=("robot", "conventional"), rounds=rounds), Quiet())
    mutants, left_out = planned.mutants, planned.left_out
    assert {mutant.family for mutant in mutants} == {"robot"}
    reasons = {omission.reason for omission in left_out if "mission.py" in omission.id}
    assert "tests fail while mutabot looks which values its text has" in reasons


def test_functions_of_the_robot_are_no_variables_whether_or_not_a_vocabulary_names_them(
    tmp_path: Path,
) -> None:
    robot = """
        def close():
            return 1

        def open():
            return 2

        def unnamed():
            return 3
    """
    mission = """
        from robot import close, open, unnamed

        def call(function):
            return function()

        def work(first, second):
            third = unnamed
            result = call(first) + call(second) + call(third)
            return result
    """
    tests = """
        import mission
        import robot

        def test_work():
            assert mission.work(robot.close, robot.open) == 6
    """
    vocabulary = "".join(f'[[operation]]\ncall = "robot:{name}"\n' for name in ("close", "open"))
    found = []
    for number, described in enumerate((vocabulary, '[[operation]]\ncall = "robot:unnamed"\n')):
        folder = tmp_path / str(number)
        folder.mkdir()
        project = write_project(folder, mission, tests, robot=robot, vocabulary=described)
        planned = plan_only(request_for(project, families=("conventional",)), Quiet())
        found.append(sorted(mutant.id for mutant in planned.mutants))
    assert found[0] == found[1]
    assert not any(":SVR:" in name or "→ second" in name for name in found[0])
