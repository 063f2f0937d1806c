"""The way of a call is the same for all calls, and the program cannot tell that it is there."""

from __future__ import annotations

import pytest

from tests.runtime.stage import Make

ROBOT = """
    import asyncio

    LOG = []

    class Feed:
        def __init__(self, parts): self.parts = iter(parts)
        def __iter__(self): return self
        def __next__(self): return next(self.parts)

    class Arm:
        def move(self, x):
            LOG.append(x)
            return x

        async def amove(self, x):
            LOG.append(x)
            return x

    def move(x):
        LOG.append(x)
        return x

    async def amove(x):
        LOG.append(x)
        return x

    def wait(x):
        return asyncio.run(amove(x))

    def refuse(x):
        raise ValueError(x)

    async def arefuse(x):
        raise ValueError(x)
"""
X = 'arguments.x = { kind = "translation", axis = "x", unit = "m", mode = "by" }'


def vocabulary(*targets: str) -> str:
    return "\n".join(f'[[operation]]\ncall = "robot:{target}"\n{X}' for target in targets)


def program(call: str) -> str:
    if not call.startswith("await "):
        return f"import robot\n\ndef run():\n    return {call}\n"
    return f"""
        import asyncio
        import robot

        async def go():
            return {call}

        def run():
            return asyncio.run(go())
    """


def test_plain_and_async_calls_leave_the_same_trace(make_stage: Make) -> None:
    traces = []
    for call, target in (("robot.move(0.25)", "move"), ("await robot.amove(0.25)", "amove")):
        stage = make_stage(ROBOT, program(call), vocabulary(target))
        session = stage.session()
        assert stage.run(session) == 0.25
        traces.append(session.recorder.trace)
    assert traces[0] == traces[1]
    assert len(traces[0]) == 1


@pytest.mark.parametrize("bound", [True, False])
@pytest.mark.parametrize("name", ["move", "amove"])
def test_a_call_through_the_class_is_read_like_any_other(make_stage: Make, name: str, bound: bool) -> None:
    """As a wrapper that a test puts around a method calls it."""
    call = f"robot.Arm().{name}(0.25)" if bound else f"robot.Arm.{name}(robot.Arm(), 0.25)"
    call = f"await {call}" if name == "amove" else call
    stage = make_stage(ROBOT, program(call), vocabulary(f"Arm.{name}"))
    session = stage.session()
    assert stage.run(session) == 0.25
    (hit,) = session.recorder.trace
    assert hit[1] == {"x": 0.25}


@pytest.mark.parametrize(
    ("call", "target"), [("robot.refuse(1.0)", "refuse"), ("await robot.arefuse(1.0)", "arefuse")]
)
def test_a_call_that_raises_is_noted_and_what_it_raised_is_unchanged(
    make_stage: Make, call: str, target: str
) -> None:
    stage = make_stage(ROBOT, program(call), vocabulary(target))
    session = stage.session()
    with pytest.raises(ValueError, match=r"^1\.0$") as caught:
        stage.run(session)
    assert (caught.value.__cause__, caught.value.__context__) == (None, None)
    assert [hit[1] for hit in session.recorder.trace] == [{"x": 1.0}]


def test_a_plain_operation_may_run_an_event_loop_of_its_own(make_stage: Make) -> None:
    stage = make_stage(ROBOT, program("robot.wait(0.25)"), vocabulary("wait"))
    assert stage.run(stage.session()) == 0.25
    assert stage.mutated("reverse", "x")[0] == -0.25


def test_an_iterator_that_is_an_operation_ends_its_loop(make_stage: Make) -> None:
    lines = (
        '[[operation]]\ncall = "robot:Feed.__next__"\nresult = { kind = "label", values = ["red", "blue"] }\n'
    )
    text = "import robot\n\ndef run():\n    return [part for part in robot.Feed(['red', 'blue'])]\n"
    stage = make_stage(ROBOT, text, lines)
    session = stage.session()
    assert stage.run(session) == ["red", "blue"]
    assert [hit[2] for hit in session.recorder.trace] == [{"result": "red"}, {"result": "blue"}, {}]
    assert stage.mutated("misread", "result")[0] == ["blue", "red"]


@pytest.mark.parametrize("operator", ["identity", "reverse", "repeat"])
def test_a_program_without_end_to_its_calls_is_no_fault_of_the_operator(
    make_stage: Make, operator: str
) -> None:
    program = """
        import robot

        def endless():
            robot.move(0.25)
            endless()

        def run():
            try:
                endless()
            except RecursionError:
                return "caught"
    """
    stage = make_stage(ROBOT, program, vocabulary("move"))
    result, mutated = stage.mutated(operator, "x" if operator == "reverse" else None)
    assert (result, mutated.activity.failure) == ("caught", None)
