"""Calls of the program in what an operation calls back are sites; what an operation does itself is none."""

from __future__ import annotations

from textwrap import dedent
from unittest.mock import Mock

import pytest

from tests.runtime.stage import Make

ROBOT = """
    import asyncio
    import contextvars
    import threading

    LOG = []

    def beep(x):
        LOG.append(("beep", x))

    def call_now(function, *given):
        return function(*given)

    def in_context(function):
        return contextvars.copy_context().run(function)

    def in_thread(function):
        context = contextvars.copy_context()
        thread = threading.Thread(target=context.run, args=(function,))
        thread.start()
        thread.join()

    def iterate(steps):
        return list(steps)

    def later(function):
        asyncio.get_running_loop().call_later(0.0, function)

    def task(work):
        return asyncio.ensure_future(work)

    async def awaits(function):
        await asyncio.sleep(0.0)
        return await function()

    async def alarm():
        await asyncio.sleep(0.0)
        beep(7.0)

    def whole(kind):
        if kind == "plain":
            beep(1.0)
        elif kind == "context":
            contextvars.copy_context().run(beep, 1.0)
        elif kind == "fresh":
            contextvars.Context().run(beep, 1.0)
        elif kind == "thread":
            in_thread(lambda: beep(1.0))
        elif kind == "task":
            asyncio.ensure_future(alarm())

    async def amove(kind):
        if kind == "gather":
            await asyncio.gather(alarm(), alarm())
        await alarm()

    class Template:
        def run(self):
            beep(1.0)
            self.step()

        def step(self):
            pass
"""
NAMES = (
    "beep", "call_now", "in_context", "in_thread", "iterate", "later", "task", "awaits", "whole", "amove",
    "Template.run",
)  # fmt: skip
X = '\narguments.x = { kind = "translation", axis = "x", unit = "m", mode = "by" }\n'
VOCABULARY = "".join(
    f'[[operation]]\ncall = "robot:{name}"{X if name == "beep" else chr(10)}' for name in NAMES
)


def program(*lines: str, is_async: bool = False) -> str:
    """A program whose sixth line is the first of these, in a function."""
    head = "import asyncio\nimport functools\nimport robot\n\n"
    body = "".join(f"    {line}\n" for line in lines)
    run = "\ndef run():\n    return asyncio.run(main())\n" if is_async else ""
    return head + ("async def main():\n" if is_async else "def run():\n") + body + run


SYNC = {
    "a function": ["def back(): robot.beep(2.0)", "robot.call_now(back)"],
    "a function in the context that an operation left": [
        "def back(): robot.beep(2.0)",
        "robot.in_context(back)",
    ],
    "a function in a thread with that context": ["def back(): robot.beep(2.0)", "robot.in_thread(back)"],
    "a generator": ["def steps(): yield robot.beep(2.0)", "robot.iterate(steps())"],
    "a method that a class of the program fills in": [
        "class Mine(robot.Template):",
        "    def step(self): robot.beep(2.0)",
        "Mine().run()",
    ],
    "a callback in a callback": [
        "def inner(): robot.beep(2.0)",
        "robot.call_now(lambda: robot.call_now(inner))",
    ],
    "a partial": ["def back(x): robot.beep(x)", "robot.call_now(functools.partial(back, 2.0))"],
    "a loop of the program": ["async def back(): robot.beep(2.0)", "robot.call_now(asyncio.run, back())"],
}
ASYNC = {
    "a timer of the loop": [
        "def back(): robot.beep(2.0)",
        "robot.later(back)",
        "await asyncio.sleep(0.001)",
    ],
    "a task": ["async def back(): robot.beep(2.0)", "await robot.task(back())"],
    "a coroutine function": ["async def back(): robot.beep(2.0)", "await robot.awaits(back)"],
}
ALL = [(name, lines, name in ASYNC) for name, lines in (SYNC | ASYNC).items()]


@pytest.mark.parametrize(("lines", "is_async"), [case[1:] for case in ALL], ids=[case[0] for case in ALL])
def test_a_call_of_the_program_in_what_an_operation_calls_back_is_a_site(
    make_stage: Make, lines: list[str], is_async: bool
) -> None:
    stage = make_stage(dedent(ROBOT), program(*lines, is_async=is_async), VOCABULARY)
    stage.run(stage.session())
    found = {(seen.span.line, seen.operation.partition(":")[2]) for seen in stage.sites()}
    wanted = next(number for number, line in enumerate(lines, 6) if "robot.beep(" in line)
    assert [line for line, operation in found if operation == "beep"] == [wanted]
    assert len(found) >= 2  # the operation that calls it back, too


@pytest.mark.parametrize("name", [name for name, *_ in ALL])
def test_a_mutant_acts_on_a_call_in_a_callback(make_stage: Make, name: str) -> None:
    text = program(*(SYNC | ASYNC)[name], is_async=name in ASYNC)
    stage = make_stage(dedent(ROBOT), text, VOCABULARY)
    begun_first = name in ("a timer of the loop", "a task")  # what begins it is over before
    _, mutant = stage.mutated("reverse", "x", index=1 if begun_first else 0)
    assert mutant.activity.acted == 1
    assert ("beep", -2.0) in stage.load_robot().LOG


@pytest.mark.parametrize("kind", ["plain", "context", "fresh", "thread"])
def test_what_an_operation_calls_itself_is_no_site(make_stage: Make, kind: str) -> None:
    stage = make_stage(dedent(ROBOT), program(f"robot.whole({kind!r})"), VOCABULARY)
    stage.run(stage.session())
    assert [seen.operation.partition(":")[2] for seen in stage.sites()] == ["whole"]
    assert stage.load_robot().LOG == [("beep", 1.0)]


@pytest.mark.parametrize(
    ("lines", "operation"),
    [
        (["robot.whole('task')", "await asyncio.sleep(0.001)"], "whole"),
        (["await robot.amove('alone')"], "amove"),
        (["await robot.amove('gather')"], "amove"),
    ],
)
def test_a_task_that_an_operation_begins_for_itself_has_no_site(
    make_stage: Make, lines: list[str], operation: str
) -> None:
    stage = make_stage(dedent(ROBOT), program(*lines, is_async=True), VOCABULARY)
    stage.run(stage.session())
    assert [seen.operation.partition(":")[2] for seen in stage.sites()] == [operation]
    assert ("beep", 7.0) in stage.load_robot().LOG


def test_an_operation_that_is_handed_to_another_is_a_site_where_it_is_handed(make_stage: Make) -> None:
    stage = make_stage(dedent(ROBOT), program("robot.call_now(robot.beep, 2.0)"), VOCABULARY)
    stage.run(stage.session())
    found = [(seen.span.line, seen.operation.partition(":")[2]) for seen in stage.sites()]
    assert sorted(found) == [(6, "beep"), (6, "call_now")]


def test_an_operation_that_calls_by_name_what_was_also_handed_on_does_it_itself(make_stage: Make) -> None:
    lines = ["robot.call_now(robot.beep, 2.0)", "robot.whole('plain')"]
    stage = make_stage(dedent(ROBOT), program(*lines), VOCABULARY)
    session = stage.session()
    stage.run(session)
    calls = [
        session.recorder.sites[index].operation.partition(":")[2] for index, *_ in session.recorder.trace
    ]
    assert calls == ["beep", "call_now", "whole"]


def test_a_call_in_what_a_mock_calls_back_is_a_site(make_stage: Make) -> None:
    lines = [
        "arm.watch(lambda: arm.lift(2.0))",
        "arm.hold(arm.lift)",
    ]
    text = program(*lines).replace("def run()", "def run(arm)")
    vocabulary = "".join(f'[[operation]]\nmethod = "{name}"\n' for name in ("watch", "hold", "lift"))
    arm = Mock()
    arm.watch.side_effect = lambda function: function()
    arm.hold.side_effect = lambda function: function(1.0)
    stage = make_stage("X = 1\n", text, vocabulary)
    stage.run(stage.session(), "run", arm)
    found = sorted((seen.span.line, seen.operation) for seen in stage.sites())
    assert found == [(6, "*:*.lift"), (6, "*:*.watch"), (7, "*:*.hold"), (7, "*:*.lift")]


def test_the_trace_has_a_call_in_a_callback_before_the_operation_around_it(make_stage: Make) -> None:
    lines = ["def back(): robot.beep(2.0)", "robot.call_now(back)", "robot.beep(3.0)"]
    stage = make_stage(dedent(ROBOT), program(*lines), VOCABULARY)
    session = stage.session()
    times = iter(range(100))
    session.recorder.clock = lambda: float(next(times))
    stage.run(session)
    assert [call.written for call in session.recorder.recorded_calls()] == [{"x": 2.0}, {}, {"x": 3.0}]
    assert session.recorder.when == [(1.0, 2.0), (0.0, 3.0), (4.0, 5.0)]
