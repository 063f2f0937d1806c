"""Commands that are left out: what the program gets instead of an answer, and that the robot does nothing."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from textwrap import dedent

import pytest

from mutabot import extensions
from mutabot.campaign.checking import plan_only
from mutabot.errors import OperatorError
from mutabot.model import Outcome, Verdict
from mutabot.operators import registry
from tests.campaign.project import REPLAY, Quiet, request_for, run, write_project

#: async programs open a socket pair, which fork leaves to replay
ENGINES = ["auto", REPLAY]
CONFIGURATION = """
    program = ["mission.py"]
    vocabulary = ["robot.toml"]
    pytest_args = ["-o", "pythonpath=."]
    rounds = 1
"""
#: every way to answer that users have; each command notes in LOG that the robot did it
ROBOT = """
    import asyncio
    from collections import namedtuple
    from dataclasses import dataclass

    LOG = []
    Stamped = namedtuple("Stamped", "time pose")

    @dataclass(frozen=True)
    class Pose:
        x: float
        y: float

    class Handle:
        def __init__(self, arm):
            self.arm = arm

    class Arm:
        def __init__(self):
            self.x = 0.0

        def poses(self, x):
            LOG.append("poses")
            return [Pose(x, 0.0), Stamped(1.5, Pose(x, 1.0))]

        def fluent(self, x):
            LOG.append("fluent")
            return self

        async def later(self, x):
            LOG.append("later")
            await asyncio.sleep(0)
            return {"pose": Pose(x, 2.0), "path": ((0.0, x),)}

        def start(self, x):
            LOG.append("start")
            return Handle(lambda: self)

        def stop(self, x):
            return Handle(lambda: self)

        def ask(self, x):
            LOG.append("ask")
            return Handle(lambda: self)

        def reset(self, x):
            return Handle(lambda: self)

        def step(self, action):
            LOG.append("step")
            self.x += action
            return (Pose(self.x, 0.0), self.x >= 0.25, {})

    def send(text):
        LOG.append(text)
        return Stamped(0.5, text.partition("/")[0])
"""
MISSION = """
    import asyncio
    from robot import send

    def poses(arm):
        first, stamped = arm.poses(0.5)
        return [first.x, stamped.time, stamped.pose.y]

    def fluent(arm):
        return arm.fluent(0.5) is arm

    def later(arm):
        got = asyncio.run(arm.later(0.5))
        return [got["pose"].y, got["path"]]

    def texts(arm):
        return send("stop").pose, send("lift/5").pose

    def started(arm):
        return arm.start(0.5)

    def asked(arm):
        return arm.ask(0.5)

    def stopped(arm):
        return arm.stop(0.5)

    def resets(arm):
        return arm.reset(0.5)

    def steps(arm):
        seen = []
        for _ in range(4):
            pose, done, _ = arm.step(0.125)
            seen.append(pose.x)
            if done:
                break
        return seen

    def twice(arm):
        arm.step(0.5)
        return [arm.step(0.125)[0].x for _ in range(2)]

    def one_pose(arm, x):
        return arm.poses(x)[0].x
"""
TESTS = """
    import pytest
    import mission, robot

    @pytest.fixture
    def arm():
        yield robot.Arm()
        robot.LOG.clear()  # else a test would find what another one did

    @pytest.mark.parametrize("name, answer, log", [
        ("poses", [0.5, 1.5, 1.0], ["poses"]),
        ("fluent", True, ["fluent"]),
        ("later", [2.0, ((0.0, 0.5),)], ["later"]),
        ("texts", ("stop", "lift"), ["stop", "lift/5"]),
    ])
    def test_a_way_to_answer(arm, name, answer, log):
        assert getattr(mission, name)(arm) == answer, "the answer"
        assert robot.LOG == log, "the robot"

    def test_what_the_vocabulary_says(arm):
        started, asked = mission.started(arm), mission.asked(arm)
        assert isinstance(started, robot.Handle) or (started == [1, {"a": 2.5}] and "start" not in robot.LOG)
        assert isinstance(asked, robot.Handle) or (asked == robot.Pose(0.0, 0.0) and "ask" not in robot.LOG)
        mission.stopped(arm)
        mission.resets(arm)

    def test_steps(arm):
        seen = mission.steps(arm)
        assert (seen, arm.x) in (([0.125, 0.25], 0.25), ([0.125] * 4, 0.0))

    def test_twice(arm):
        assert mission.twice(arm) in ([0.625, 0.75], [0.5, 0.5], [0.125, 0.25])

    @pytest.mark.parametrize("x", [0.25, 0.5, 0.75])
    def test_one_pose(arm, x):
        assert mission.one_pose(arm, x) == x
"""


def operation(call: str, argument: str = "x", more: str = "") -> str:
    quantity = '{ kind = "translation", axis = "x", unit = "m", mode = "to" }'
    return f'[[operation]]\ncall = "robot:Arm.{call}"\narguments.{argument} = {quantity}\n{more}\n'


VOCABULARY = "\n".join(
    [
        *(operation(call) for call in ("poses", "fluent", "later", "stop")),
        operation("step", "action"),
        operation("start", more="idle = [1, { a = 2.5 }]"),
        operation("ask", more='idle = { call = "answers:nowhere" }'),
        operation("reset", more='idle = { call = "answers:broken" }'),
        """
[[operation]]
call = "robot:send"
message = "text"
patterns = [
  { text = "lift/{x:g}", kind = "translation", axis = "z", unit = "cm", mode = "by" },
  { text = "stop" },
]
""",
    ]
)
ANSWERS = """
    from robot import Pose

    def nowhere():
        return Pose(0.0, 0.0)

    def broken():
        raise ZeroDivisionError("no answer")
"""


def project(folder: Path, mission: str, tests: str, vocabulary: str) -> Path:
    more = {"answers.py": dedent(ANSWERS)}
    return write_project(
        folder, mission, tests, robot=ROBOT, vocabulary=vocabulary, configuration=CONFIGURATION, more=more
    )


@pytest.fixture(scope="module", params=ENGINES)
def found(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Outcome]:
    """How the mutants that leave a command out ended, by the function and the call they are in."""
    folder = project(tmp_path_factory.mktemp("project"), MISSION, TESTS, VOCABULARY)
    outcomes = run(folder, engine=request.param, only=("skip",))
    return {name.partition(":")[2].partition(":skip")[0]: outcome for name, outcome in outcomes.items()}


#: the mutant, and what it is killed by where the robot's log is looked at: never by its answer
LEFT_OUT = ["poses:arm.poses#1:call", "fluent:arm.fluent#1:call", "later:arm.later#1:call"]
LEFT_OUT += ["texts:send#1:stop", "texts:send#2:lift/{x}"]


@pytest.mark.parametrize("mutant", LEFT_OUT)
def test_a_command_that_answers_no_plain_value_is_left_out_and_the_program_goes_on(
    mutant: str, found: dict[str, Outcome]
) -> None:
    outcome = found[mutant]
    assert (outcome.verdict, outcome.acted, outcome.hits) == (Verdict.KILLED, 1, 1)
    assert (outcome.message or "").startswith("the robot")


def test_answers_that_change_stand_still_with_the_robot(found: dict[str, Outcome]) -> None:
    """The recorded episode is not played to the program: it would see a success that never was."""
    outcome = found["steps:arm.step#1:call"]
    assert (outcome.verdict, outcome.acted, outcome.hits) == (Verdict.SURVIVED, 4, 4)


def test_an_answer_that_changes_is_the_last_one_that_the_robot_gave(found: dict[str, Outcome]) -> None:
    outcome = found["twice:arm.step#2:call"]
    assert (outcome.verdict, outcome.acted, outcome.hits) == (Verdict.SURVIVED, 2, 2)


def test_each_test_gets_the_answer_that_it_had_itself(found: dict[str, Outcome]) -> None:
    outcome = found["one_pose:arm.poses#1:call"]
    assert (outcome.verdict, outcome.acted, outcome.hits) == (Verdict.SURVIVED, 3, 3)


@pytest.mark.parametrize("mutant", ["started:arm.start#1:call", "asked:arm.ask#1:call"])
def test_the_vocabulary_can_say_what_to_answer(mutant: str, found: dict[str, Outcome]) -> None:
    outcome = found[mutant]
    assert (outcome.verdict, outcome.acted, outcome.hits) == (Verdict.SURVIVED, 1, 1)


def test_a_function_of_the_vocabulary_that_fails_is_an_error_and_never_a_kill(
    found: dict[str, Outcome],
) -> None:
    outcome = found["resets:arm.reset#1:call"]
    assert (outcome.verdict, outcome.acted) == (Verdict.ERROR, 0)
    assert "ZeroDivisionError: no answer" in (outcome.message or "")


def test_a_mutant_without_an_answer_is_left_out_with_the_reason(
    found: dict[str, Outcome], tmp_path: Path
) -> None:
    assert "stopped:arm.stop#1:call" not in found
    folder = project(tmp_path, USES_HANDLE, TEST_OF_HANDLE, operation("start"))
    left_out = plan_only(request_for(folder), Quiet()).left_out
    (reason,) = [omission.reason for omission in left_out if omission.id.endswith(":skip")]
    assert reason == (
        "it returns a builtins:function, which cannot be stored; "
        "say in the vocabulary what it returns while the robot does nothing: idle = …"
    )


@pytest.mark.parametrize("line", ["arm.start(0.5)", "await arm.start(0.5)"])
def test_a_statement_by_itself_needs_no_answer_to_be_left_out(tmp_path: Path, line: str) -> None:
    is_async = line.startswith("await")
    mission = f"{'async ' if is_async else ''}def run(arm):\n    {line}\n"
    made = "mock.AsyncMock" if is_async else "mock.MagicMock"
    run = "asyncio.run(mission.run(arm))" if is_async else "mission.run(arm)"
    tests = f"""
        import asyncio
        from unittest import mock

        import mission, robot

        def test_it():
            arm = mock.Mock(spec=robot.Arm)
            arm.start = {made}()
            {run}
            arm.start.assert_called_once_with(0.5)
    """
    folder = project(tmp_path, mission, tests, operation("start"))
    planned = plan_only(request_for(folder), Quiet())
    plan, left_out = planned.mutants, planned.left_out
    assert "skip" in {mutant.operator for mutant in plan}
    assert left_out == []


USES_HANDLE = "def run(arm):\n    return arm.start(0.5)\n"
TEST_OF_HANDLE = """
    import mission, robot

    def test_it():
        mission.run(robot.Arm())
"""


#: a plug-in with the body of skip, under another name
LOST = """
    from mutabot.operators import Need, Operator

    class Rule(Operator):
        name = "lost"
        needs = frozenset({Need.IDLE})
        summary = "A command is lost on its way."

        def subjects(self, whole):
            return [whole]

        def middleware(self, subject, random):
            async def mutated(call, proceed):
                return call.idle

            return mutated

        def describe(self, subject, before, after):
            return "is lost"
"""
#: the same, but it does not say that it asks for an answer
UNDECLARED = LOST.replace("needs = frozenset({Need.IDLE})", "")
#: promises to do nothing, and makes the call where it is at work
STUBBORN = LOST.replace(
    "needs = frozenset({Need.IDLE})", "needs, does_nothing = frozenset({Need.IDLE}), True"
).replace("return call.idle", "return call.idle if call.payload is None else await proceed(call)")


@pytest.fixture
def plug_in(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Callable[[str], None]]:
    """Makes an operator known as an installed plug-in does, here and in all workers."""

    def install(code: str) -> None:
        site = tmp_path / "site"
        details = site / "lost_plug_in-1.0.dist-info"
        details.mkdir(parents=True)
        (details / "METADATA").write_text("Metadata-Version: 2.1\nName: lost-plug-in\nVersion: 1.0\n")
        (details / "entry_points.txt").write_text("[mutabot]\nlost = lost_extension:EXTENSION\n")
        (site / "lost_extension.py").write_text(
            "from mutabot.extensions import INTERFACE, Extension\n"
            "EXTENSION = Extension(INTERFACE, operators={'lost': 'lost_plug_in:Rule'})\n"
        )
        (site / "lost_plug_in.py").write_text(dedent(code))
        monkeypatch.syspath_prepend(str(site))
        monkeypatch.setenv("PYTHONPATH", str(site))
        for module in ("lost_extension", "lost_plug_in"):
            monkeypatch.delitem(sys.modules, module, raising=False)
        forget()

    def forget() -> None:
        registry.operator.cache_clear()
        extensions._declared.cache_clear()

    yield install
    forget()


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_an_operator_of_another_name_with_the_body_of_skip_ends_as_skip(
    engine: str, plug_in: Callable[[str], None], tmp_path: Path
) -> None:
    plug_in(LOST)
    mission = "def run(arm):\n    return arm.poses(0.5)[0].x\n"
    tests = """
        import mission, robot

        def test_it():
            assert mission.run(robot.Arm()) == 0.5
        """
    folder = project(tmp_path / "project", mission, tests, operation("poses"))
    found = run(folder, engine=engine, only=("skip", "lost"))
    assert {(outcome.verdict, outcome.acted) for outcome in found.values()} == {(Verdict.SURVIVED, 1)}
    assert len(found) == 2


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_an_operator_that_is_to_do_nothing_and_reaches_the_robot_is_an_error(
    engine: str, plug_in: Callable[[str], None], tmp_path: Path
) -> None:
    plug_in(STUBBORN)
    vocabulary = operation("start", more="idle = 1")
    folder = project(tmp_path / "project", USES_HANDLE, TEST_OF_HANDLE, vocabulary)
    (outcome,) = run(folder, engine=engine, only=("lost",)).values()
    assert outcome.verdict is Verdict.ERROR
    assert outcome.message == "operator lost is to do nothing, but would have made the call"


def test_an_operator_that_asks_without_saying_so_is_reported(
    plug_in: Callable[[str], None], tmp_path: Path
) -> None:
    plug_in(UNDECLARED)
    folder = project(tmp_path / "project", USES_HANDLE, TEST_OF_HANDLE, operation("start"))
    with pytest.raises(
        OperatorError, match=r"'lost' answers with call.idle, but Need.IDLE is none of its needs"
    ):
        plan_only(request_for(folder), Quiet())
