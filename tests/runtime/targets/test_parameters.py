"""Callables that do not tell their arguments: native ones, and those behind careless decorators."""

from __future__ import annotations

from typing import Any

import pytest

from mutabot.model.events import Problem, Remark
from tests.runtime.stage import Make, Stage

#: ``hexlify(data, sep, bytes_per_sep)`` of the standard library tells no signature and takes keywords:
#: groups of bytes are counted from the right, and from the left if their size is negative
NATIVE = """
    from binascii import hexlify as group
    from socket import htons as swap

    class Arm:
        group = staticmethod(group)
"""
SIZE = '{ kind = "translation", axis = "x", unit = "m", mode = "by" }'
FROM_RIGHT, FROM_LEFT = b"01:0203", b"0102:03"
DATA = "bytes([1, 2, 3])"


def program_with(call: str) -> str:
    return f"import robot\n\ndef run():\n    return robot.{call}\n"


def vocabulary_with(signature: str | None, target: str = "group", argument: str = "bytes_per_sep") -> str:
    line = f'signature = "{signature}"\n' if signature is not None else ""
    return f'[[operation]]\ncall = "robot:{target}"\n{line}arguments.{argument} = {SIZE}\n'


@pytest.mark.parametrize(
    ("call", "signature"),
    [
        ("group(DATA, ':', bytes_per_sep=2)", None),
        ("group(bytes_per_sep=2, data=DATA, sep=':')", None),
        ("group(DATA, ':', 2)", "(data, sep, bytes_per_sep)"),
        ("group(DATA, ':', 2)", "(data, sep=…, bytes_per_sep=…)"),
        ("group(DATA, ':', 2)", "(data, sep, bytes_per_sep, …)"),
        ("group(DATA, ':', bytes_per_sep=2)", "(data, …)"),
        ("group(data=DATA, sep=':', bytes_per_sep=2)", "(data, sep, bytes_per_sep)"),
        ("group(DATA, bytes_per_sep=2, sep=':')", "(data, sep, bytes_per_sep)"),
        ("Arm.group(DATA, ':', 2)", "(data, sep, bytes_per_sep)"),
        ("Arm().group(DATA, ':', 2)", "(data, sep, bytes_per_sep)"),
    ],
)
def test_an_argument_of_a_native_function_is_found_and_replaced(
    make_stage: Make, call: str, signature: str | None
) -> None:
    target = call.partition("(")[0].replace("()", "")
    target = "Arm.group" if call.startswith("Arm") else target
    stage = make_stage(
        NATIVE, program_with(call.replace("DATA", DATA)), vocabulary_with(signature, target=target)
    )
    result, activation = stage.mutated("reverse", "bytes_per_sep")
    assert result == FROM_LEFT
    assert activation.activity.example == (2, -2)


def test_positional_arguments_of_a_native_function_are_not_guessed(make_stage: Make) -> None:
    stage = make_stage(NATIVE, program_with(f"group({DATA}, ':', 2)"), vocabulary_with(None))
    result, activation = stage.mutated("reverse", "bytes_per_sep")
    assert (result, activation.activity.acted) == (FROM_RIGHT, 0)


def test_a_native_function_is_never_given_what_the_program_left_out(make_stage: Make) -> None:
    """``htons`` takes one argument, and no keyword."""
    vocabulary = vocabulary_with("(x, mode=0, …)", target="swap", argument="x")
    stage = make_stage(NATIVE, program_with("swap(1)"), vocabulary)
    result, activation = stage.mutated("repeat")
    assert (result, activation.activity.acted) == (256, 1)


DECORATED = """
    import functools

    SEEN = []

    def logged(function):
        def wrapper(*args, **kwargs):
            SEEN.append((args[1:], kwargs))
            return function(*args, **kwargs)
        return wrapper

    def faithful(function):
        @functools.wraps(function)
        def wrapper(*args, **kwargs):
            return function(*args, **kwargs)
        return wrapper

    class Arm:
        @logged
        def move(self, dx, dy=0.25, *, speed=1.0):
            return dx, dy, speed

        @faithful
        def go(self, dx, dy=0.25, *, speed=1.0):
            return dx, dy, speed

        @logged
        @logged
        def twice(self, dx): return dx

    def plain(*axes, **options): return axes
"""
MOVED = "(self, dx, dy=0.25, *, speed=1.0)"


@pytest.mark.parametrize(
    ("call", "argument", "seen", "result"),
    [
        ("1.0", "dx", ((-1.0,), {}), (-1.0, 0.25, 1.0)),
        ("dx=1.0", "dx", ((), {"dx": -1.0}), (-1.0, 0.25, 1.0)),
        ("1.0, 0.5", "dy", ((1.0, -0.5), {}), (1.0, -0.5, 1.0)),
        ("1.0, dy=0.5", "dy", ((1.0,), {"dy": -0.5}), (1.0, -0.5, 1.0)),
        ("1.0", "dy", ((1.0,), {"dy": -0.25}), (1.0, -0.25, 1.0)),
        ("1.0, speed=2.0", "speed", ((1.0,), {"speed": -2.0}), (1.0, 0.25, -2.0)),
    ],
)
def test_a_decorated_method_is_read_by_the_signature_that_the_vocabulary_gives(
    make_stage: Make, call: str, argument: str, seen: Any, result: Any
) -> None:
    vocabulary = vocabulary_with(MOVED, target="Arm.move", argument=argument)
    stage = make_stage(DECORATED, program_with(f"Arm().move({call})"), vocabulary)
    assert stage.mutated("reverse", argument)[0] == result
    assert stage.load_robot().SEEN[-1] == seen


def remarks(stage: Stage) -> list[Remark]:
    return [line for line in stage.writer.lines if isinstance(line, Remark)]


def looked_at(stage: Stage) -> list[Remark]:
    stage.load_program()
    session = stage.session()
    for operation in session.job.vocabulary.operations:
        session.inspection.check_target(operation, session.targets)
    return remarks(stage)


@pytest.mark.parametrize(
    ("robot", "target", "argument", "words"),
    [
        (NATIVE, "group", "bytes_per_sep", ["is native", '"(bytes_per_sep, …)"', "in their order"]),
        (DECORATED, "Arm.move", "dx", ["*args", 'signature = "(dx, …)"']),
        (DECORATED, "plain", "dx", ['signature = "(dx, …)"']),
    ],
)
def test_a_callable_whose_arguments_are_unknown_is_remarked_with_what_to_write(
    make_stage: Make, robot: str, target: str, argument: str, words: list[str]
) -> None:
    stage = make_stage(robot, "import robot\n", vocabulary_with(None, target=target, argument=argument))
    (remark,) = looked_at(stage)
    assert (remark.source.partition(" ")[0], remark.key) == ("robot.toml:1", "signature")
    assert all(word in remark.text for word in words)


@pytest.mark.parametrize(
    ("robot", "vocabulary"),
    [
        (NATIVE, vocabulary_with("(data, sep, bytes_per_sep)")),
        (NATIVE, '[[operation]]\ncall = "robot:group"\n'),
        (DECORATED, vocabulary_with("(self, dx, …)", target="Arm.move", argument="dx")),
        (DECORATED, vocabulary_with(None, target="Arm.go", argument="dx")),
        (DECORATED, vocabulary_with(None, target="plain", argument='"axes[0]"')),
    ],
    ids=["given", "nothing described", "given for a method", "wraps", "named rest"],
)
def test_nothing_is_remarked_where_the_arguments_can_be_distinguished(
    make_stage: Make, robot: str, vocabulary: str
) -> None:
    stage = make_stage(robot, "import robot\n", vocabulary)
    assert not looked_at(stage)
    assert not stage.writer.lines


@pytest.mark.parametrize("when", ["", 'when = { argument = "data", value = "x" }\n'], ids=["", "some calls"])
def test_a_signature_that_does_not_take_a_call_is_a_problem(make_stage: Make, when: str) -> None:
    stage = make_stage(
        NATIVE, program_with(f"group({DATA}, ':', 2)"), vocabulary_with("(data, bytes_per_sep)") + when
    )
    assert stage.run(stage.session()) == FROM_RIGHT
    (problem,) = [line for line in stage.writer.lines if isinstance(line, Problem)]
    assert problem.key == "signature"
    assert problem.text == "(data, bytes_per_sep) does not take the call (…, …, …)"


@pytest.mark.parametrize("when", ["", 'when = { argument = "x", value = "1" }\n'], ids=["", "some calls"])
def test_a_call_that_the_callable_itself_refuses_is_no_problem(make_stage: Make, when: str) -> None:
    vocabulary = vocabulary_with("(x)", target="swap", argument="x") + when
    stage = make_stage(NATIVE, program_with("swap()"), vocabulary)
    with pytest.raises(TypeError):
        stage.run(stage.session())
    assert not [line for line in stage.writer.lines if isinstance(line, Problem)]


def test_an_argument_that_is_none_is_one_that_the_call_does_not_give(make_stage: Make) -> None:
    robot = "def move(pose=None):\n    return pose\n"
    stage = make_stage(robot, program_with("move()"), vocabulary_with(None, "move", '"pose[0]"'))
    assert stage.run(stage.session()) is None
    assert not [line for line in stage.writer.lines if isinstance(line, Problem)]
