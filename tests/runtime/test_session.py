"""Sites, nesting, activity, budgets and noise."""

from __future__ import annotations

import pytest

from mutabot.model.activation import FatalFault
from mutabot.model.events import Acted, Problem
from mutabot.runtime.meter import Meter, TimeExceeded
from tests.runtime.stage import Make

ROBOT = """
    LOG = []

    class Refused(Exception):
        pass

    def move(x):
        if abs(x) > 1 or x < -0.5:
            raise Refused(x)
        LOG.append(x)

    def dance():
        move(0.1)
        move(0.2)

    def locate():
        return 0.5
"""
VOCABULARY = """
    refusals = ["robot:Refused"]
    [[operation]]
    call = "robot:move"
    arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    [[operation]]
    call = "robot:dance"
    [[operation]]
    call = "robot:locate"
    result = { kind = "position", axis = "x", unit = "m", noise = 1.0 }
"""


HANDLES_REFUSAL = """
    import robot

    def run():
        try:
            robot.move({})
        except robot.Refused:
            pass
"""


def test_two_calls_on_one_line_are_two_sites(make_stage: Make) -> None:
    stage = make_stage(ROBOT, "from robot import move\n\ndef run():\n    move(0.1); move(0.2)\n", VOCABULARY)
    stage.run(stage.session())
    spans = [seen.span for seen in stage.sites()]
    assert [(span.line, span.column, span.end_column) for span in spans] == [(4, 4, 13), (4, 15, 24)]


def test_a_loop_hits_one_site_many_times(make_stage: Make) -> None:
    program = "from robot import move\n\ndef run():\n    for _ in range(5):\n        move(0.1)\n"
    stage = make_stage(ROBOT, program, VOCABULARY)
    session = stage.session()
    stage.run(session)
    assert len(stage.sites()) == 1
    assert len(session.recorder.trace) == 5


def test_only_the_outermost_operation_is_a_site(make_stage: Make) -> None:
    stage = make_stage(ROBOT, "from robot import dance\n\ndef run():\n    dance()\n", VOCABULARY)
    session = stage.session()
    stage.run(session)
    assert [seen.operation for seen in stage.sites()] == [f"{stage.robot_name}:dance"]
    assert session.meter is not None
    assert session.meter.operations == 1


def test_a_call_inside_a_comprehension_belongs_to_its_function(make_stage: Make) -> None:
    program = "from robot import move\n\ndef run():\n    return [move(x) for x in (0.1, 0.2)]\n"
    stage = make_stage(ROBOT, program, VOCABULARY)
    stage.run(stage.session())
    assert [seen.span.function for seen in stage.sites()] == ["run"]


def test_a_call_from_neither_program_nor_oracle_is_no_site(make_stage: Make) -> None:
    stage = make_stage(ROBOT, "X = 1\n", VOCABULARY)
    session = stage.session()
    stage.load_robot().move(0.1)
    assert stage.sites() == []
    assert session.recorder.trace == []


def test_a_call_through_library_code_counts_for_the_programs_line(make_stage: Make) -> None:
    program = (
        "from robot import move\n\ndef run():\n    list(map(move, [0.1]))\n    sorted([0.3], key=move)\n"
    )
    stage = make_stage(ROBOT, program, VOCABULARY)
    stage.run(stage.session())
    assert [seen.span.line for seen in stage.sites()] == [4, 5]


def test_the_first_act_is_reported_at_once(make_stage: Make) -> None:
    stage = make_stage(ROBOT, "from robot import move\n\ndef run():\n    move(0.1)\n", VOCABULARY)
    stage.mutated("reverse", "x")
    told = [line for line in stage.writer.lines if isinstance(line, Acted)]
    assert told == [Acted("test", in_call=True), Acted("test", in_call=False), Acted("test")]


def test_the_fatal_control_reports_that_it_acts_before_anybody_can_wait_for_what_it_ends(
    make_stage: Make,
) -> None:
    stage = make_stage(ROBOT, "from robot import move\n\ndef run():\n    move(0.1)\n", VOCABULARY)
    with pytest.raises(FatalFault):
        stage.mutated("fatal", None)
    assert [line for line in stage.writer.lines if isinstance(line, Acted)] == [Acted("test")]


def test_a_mutant_that_changes_nothing_has_hits_but_did_not_act(make_stage: Make) -> None:
    stage = make_stage(ROBOT, "from robot import move\n\ndef run():\n    move(0.0)\n", VOCABULARY)
    _, activation = stage.mutated("reverse", "x")
    assert (activation.activity.hits, activation.activity.acted) == (1, 0)
    assert not any(isinstance(line, Acted) for line in stage.writer.lines)


def test_a_refusal_of_the_mutated_call_is_noted(make_stage: Make) -> None:
    stage = make_stage(ROBOT, HANDLES_REFUSAL.format(0.9), VOCABULARY)
    _, activation = stage.mutated("reverse", "x")
    assert activation.activity.refusal == "-0.9"


def test_a_refusal_of_the_original_call_is_no_refusal_of_the_mutant(make_stage: Make) -> None:
    stage = make_stage(ROBOT, HANDLES_REFUSAL.format(2.0), VOCABULARY)
    _, activation = stage.mutated("identity")
    assert activation.activity.refusal is None


def test_noise_is_the_same_for_the_same_seed_and_differs_between_hits(make_stage: Make) -> None:
    program = "from robot import locate\n\ndef run():\n    return [locate() for _ in range(3)]\n"
    first = make_stage(ROBOT, program, VOCABULARY)
    readings, activation = first.mutated("noise", "result")
    assert len(set(readings)) == 3
    activation.start(7, 0, "", None, frozenset())
    again = first.run(first.sessions[-1])
    activation.start(7, 0, "", None, frozenset())
    assert first.run(first.sessions[-1]) == again
    assert activation.activity.acted == 3


CLOCKED = """
    class Simulation:
        def __init__(self): self.time = 0.0
        def tick(self): self.time += 10.0; return self.time
        def step(self): self.time += 10.0
        def odd(self, state=None): return None
        async def atick(self): self.time += 10.0; return self.time
"""


@pytest.mark.parametrize(
    "clock",
    [
        'clock = { tick = "robot:Simulation.tick", unit = "ms" }',
        'clock = { tick = "robot:Simulation.step", time = "self.time", unit = "ms" }',
        'clock = { tick = "robot:Simulation.step", step = 10, unit = "ms" }',
    ],
)
def test_more_simulated_time_than_its_limit_ends_the_test(make_stage: Make, clock: str) -> None:
    tick = "tick" if "Simulation.tick" in clock else "step"
    program = f"import robot\n\ndef run():\n    s = robot.Simulation()\n    while True:\n        s.{tick}()\n"
    vocabulary = f'{clock}\n[[operation]]\ncall = "robot:Simulation.{"step" if tick == "tick" else "tick"}"\n'
    stage = make_stage(CLOCKED, program, vocabulary)
    session = stage.session(simulated=1.0)
    with pytest.raises(TimeExceeded, match="simulated time"):
        stage.run(session)


def test_simulated_time_is_no_limit_until_processor_time_was_used() -> None:
    meter = Meter(limit=1.0, spare=1e9)
    for time in range(1000):
        meter.tick(float(time))
    assert (meter.simulated, meter.exceeded) == (999.0, None)
    meter.spare = 0.0
    with pytest.raises(TimeExceeded, match="more than 1 s of simulated time"):
        meter.tick(1000.0)


@pytest.mark.parametrize(
    ("clock", "used"),
    [
        ('{ tick = "robot:Simulation.step", step = 0.25 }', 0.75),
        ('{ tick = "robot:Simulation.step", step = 250, unit = "ms" }', 0.75),
        ('{ tick = "robot:Simulation.step", time = "self.time", unit = "ms" }', 0.02),
        ('{ tick = "robot:Simulation.atick", unit = "ms" }', 0.02),
        ('{ tick = "robot:Simulation.atick", step = 0.25 }', 0.75),
    ],
)
def test_simulated_time_is_read_or_counted_in_fixed_steps(make_stage: Make, clock: str, used: float) -> None:
    """What is read begins at the first reading; every fixed step counts."""
    tick = "asyncio.run(simulation.atick())" if "atick" in clock else "simulation.step()"
    program = f"""
        import asyncio
        import robot

        def run():
            simulation = robot.Simulation()
            for _ in range(3):
                {tick}
    """
    stage = make_stage(CLOCKED, program, f'clock = {clock}\n[[operation]]\ncall = "robot:Simulation.tick"\n')
    session = stage.session()
    stage.run(session)
    assert session.meter is not None
    assert session.meter.simulated == pytest.approx(used)


@pytest.mark.parametrize(
    ("clock", "words"),
    [
        ('{ tick = "robot:Simulation.odd" }', ["what", "Simulation.odd returns gives None", "not a number"]),
        ('{ tick = "robot:Simulation.tick", time = ".time" }', ["float has no .time"]),
        ('{ tick = "robot:Simulation.tick", time = "self.tme" }', ["no .tme", "'.time'"]),
        ('{ tick = "robot:Simulation.tick", time = "self" }', ["the path 'self' gives", "not a number"]),
        ('{ tick = "robot:Simulation.odd", time = "state.t" }', ["NoneType has no .t"]),
        ('{ tick = "robot:Simulation.odd", time = "stat.t" }', ["no argument 'stat'", "it has state"]),
        ('{ tick = "robot:plain", time = "self.t" }', ["not a method", "no self"]),
        ('{ tick = "robot:nan" }', ["gives nan, which is not a number"]),
    ],
)
def test_a_clock_that_gives_no_number_is_a_problem_and_leaves_the_program_alone(
    make_stage: Make, clock: str, words: list[str]
) -> None:
    robot = CLOCKED + "\n    def plain(): pass\n\n    def nan(): return float('nan')\n"
    program = """
        import robot

        def run():
            simulation = robot.Simulation()
            return [simulation.odd(), simulation.tick(), robot.plain(), robot.nan()][:2]
    """
    stage = make_stage(robot, program, f'clock = {clock}\n[[operation]]\ncall = "robot:Simulation.step"\n')
    session = stage.session()
    assert stage.run(session) == [None, 10.0]
    (problem,) = [line for line in stage.writer.lines if isinstance(line, Problem)]
    assert (problem.source, problem.key) == ("robot.toml:1 · clock", "time")
    assert all(word in problem.text for word in [*words, "step = …"])


def test_an_operator_that_fails_is_a_failure_of_the_tool_not_of_the_program(make_stage: Make) -> None:
    vocabulary = VOCABULARY.replace(
        'call = "robot:move"', 'call = "robot:move"\n    current = "robot:locate"'
    )
    stage = make_stage(ROBOT, "from robot import move\n\ndef run():\n    move(0.1)\n", vocabulary)
    stage.load_robot().locate = lambda: None  # where the robot is cannot be read
    with pytest.raises(TypeError):
        stage.mutated("by-to", "x")
    activation = stage.sessions[-1].mutant
    assert activation is not None
    assert "operator by-to" in (activation.activity.failure or "")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("robot:Refusd", "Refusd"),
        ("robot:move", "not an exception class"),
        ("no_such_robot:Refused", "no_such_robot"),
    ],
)
def test_an_exception_that_does_not_exist_is_reported(make_stage: Make, name: str, words: str) -> None:
    stage = make_stage(ROBOT, "X = 1\n", VOCABULARY.replace("robot:Refused", name))
    stage.session().inspect_targets()
    assert any(isinstance(line, Problem) and words in line.text for line in stage.writer.lines)


@pytest.mark.parametrize(
    ("name", "words"), [("robot:nowhere", "'nowhere'"), ("robot:LIMIT", "robot:LIMIT is int, not a function")]
)
def test_a_function_that_is_to_make_an_answer_must_be_one(make_stage: Make, name: str, words: str) -> None:
    vocabulary = f"""
        [[operation]]
        call = "robot:move"
        idle = {{ call = "{name}" }}
        """
    stage = make_stage("LIMIT = 3\n\ndef move():\n    pass\n", "X = 1\n", vocabulary)
    stage.session().inspect_targets()
    (problem,) = [line for line in stage.writer.lines if isinstance(line, Problem)]
    assert problem.key == "idle"
    assert words.rpartition(":")[2] in problem.text


RE_EXPORTING = """
    from decimal import InvalidOperation as Refused

    def move(x):
        if x < 0:
            raise Refused(x)

    def dance():
        pass

    def locate():
        return 0.5
"""


def test_an_exception_is_known_by_the_name_it_was_re_exported_as(make_stage: Make) -> None:
    stage = make_stage(RE_EXPORTING, HANDLES_REFUSAL.format(0.5), VOCABULARY)
    _, activation = stage.mutated("reverse", "x")
    assert activation.activity.refusal is not None


def test_an_argument_that_cannot_be_read_does_not_hide_later_calls(make_stage: Make) -> None:
    """An operation must never stay under way: mutants of all later calls would seem to do nothing."""
    program = """
        import robot

        class Odd:
            @property
            def x(self):
                raise RuntimeError("not now")

        def run():
            try:
                robot.move(Odd())
            except TypeError:  # the robot's own
                pass
            robot.dance()
    """
    vocabulary = VOCABULARY.replace("arguments.x =", 'arguments."x.x" =')
    stage = make_stage(ROBOT, program, vocabulary)
    stage.run(stage.session())
    assert [seen.operation.partition(":")[2] for seen in stage.sites()] == ["move", "dance"]
