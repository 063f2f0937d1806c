"""Commands told apart by a text, by an object or by the value of an argument, with values beside it."""

from __future__ import annotations

from typing import Any

import pytest

from mutabot.model.events import Problem
from mutabot.runtime.interception.active_mutant import MutatedSite
from tests.runtime.stage import Make, Stage

ROBOT = """
    import enum

    LOG = []

    class Name:
        def __init__(self, text): self.text = text
        def __str__(self): return self.text

    class Node:
        \"\"\"As of an OPC-UA client: it prints the id of its node.\"\"\"
        def __init__(self, name): self.name, self.request = name, None
        def __str__(self): return self.name
        def write_value(self, value, varianttype=None): LOG.append((self.name, value))
        async def awrite(self, value): LOG.append((self.name, value))

    class Request:
        def __init__(self, node, value): self.node, self.value = node, value

    class Frame(enum.Enum):
        TOOL = 1
        BASE = 2

    def write(node, value, timeout=1.0):
        LOG.append((node, value, timeout))
        return True

    def send(request): LOG.append((request.node, request.value))

    def loose(*args, **kwargs): LOG.append((args, kwargs))

    class Arm:
        x = 0.25
        def where(self): return [self.x]
        def go(self, dx, relative=True): LOG.append((dx, relative))
        def turn(self, dx, frame): LOG.append((dx, frame))
        def stop(self): LOG.append("stop")
"""
X = 'kind = "translation", axis = "x", unit = "m"'
NODES = f"""
    patterns = [
      {{{{ text = "ns=2;s=Arm.X", arguments.value = {{{{ {X}, mode = "to" }}}} }}}},
      {{{{ text = "ns=2;s=Arm.DX", arguments.value = {{{{ {X}, mode = "by" }}}} }}}},
      {{{{ text = "ns=2;s=Grip", arguments.value = {{{{ kind = "output", values = [false, true] }}}} }}}},
      {{{{ text = "40001", arguments.value = {{{{ kind = "output", values = [0, 1] }}}} }}}},
      {{{{ text = "home" }}}},
    ]
""".replace("{{", "{").replace("}}", "}")


def vocabulary(target: str, message: str, *lines: str, patterns: str = NODES) -> str:
    head = f'[[operation]]\ncall = "robot:{target}"\nmessage = "{message}"\n'
    return head + "\n".join(lines) + patterns


def program(call: str) -> str:
    return f"""
        import asyncio
        import robot

        def run():
            robot.LOG.clear()
            {call}
            return list(robot.LOG)
    """


@pytest.mark.parametrize(
    ("call", "operator", "expected"),
    [
        ("write('ns=2;s=Arm.X', 1.5)", "reverse", ("ns=2;s=Arm.X", -1.5, 1.0)),
        ("write('ns=2;s=Arm.DX', value=1.5)", "reverse", ("ns=2;s=Arm.DX", -1.5, 1.0)),
        ("write(value=1.5, node=b'ns=2;s=Arm.X')", "reverse", (b"ns=2;s=Arm.X", -1.5, 1.0)),
        ("write('ns=2;s=Grip', True)", "opposite", ("ns=2;s=Grip", False, 1.0)),
        ("write(40001, 1)", "opposite", (40001, 0, 1.0)),
    ],
)
def test_a_value_beside_the_text_is_found_and_replaced(
    make_stage: Make, call: str, operator: str, expected: Any
) -> None:
    stage = make_stage(ROBOT, program(f"robot.{call}"), vocabulary("write", "node"))
    result, activation = stage.mutated(operator, "value")
    assert result == [expected]
    assert activation.activity.acted == 1


@pytest.mark.parametrize(
    ("target", "message", "call"),
    [
        ("write", "node", "robot.write(robot.Name('ns=2;s=Arm.X'), 1.5)"),
        ("Node.write_value", "self", "robot.Node('ns=2;s=Arm.X').write_value(1.5)"),
        ("Node.write_value", "self.name", "robot.Node('ns=2;s=Arm.X').write_value(value=1.5)"),
        ("Node.awrite", "self", "asyncio.run(robot.Node('ns=2;s=Arm.X').awrite(1.5))"),
    ],
)
def test_an_object_shows_the_command_by_what_it_prints(
    make_stage: Make, target: str, message: str, call: str
) -> None:
    stage = make_stage(ROBOT, program(call), vocabulary(target, message))
    (found,), activation = stage.mutated("reverse", "value")
    assert found[1] == -1.5
    assert str(found[0]) == "ns=2;s=Arm.X"
    assert activation.activity.example == (1.5, -1.5)
    assert {seen.pattern for seen in stage.sites()} == {"ns=2;s=Arm.X"}


def test_a_command_may_lie_inside_of_an_argument(make_stage: Make) -> None:
    patterns = f'patterns = [{{ text = "x/{{n:d}}", arguments."request.value" = {{ {X}, mode = "to" }}, '
    patterns += 'arguments.n = { kind = "output", values = [1, 2] } }]\n'
    call = "robot.send(robot.Request('x/1', 1.5))"
    stage = make_stage(ROBOT, program(call), vocabulary("send", "request.node", patterns=patterns))
    assert stage.mutated("reverse", "request.value")[0] == [("x/1", -1.5)]
    stage = make_stage(ROBOT, program(call), vocabulary("send", "request.node", patterns=patterns))
    assert stage.mutated("opposite", "n")[0] == [("x/2", 1.5)]


def test_arguments_of_the_operation_belong_to_every_command(make_stage: Make) -> None:
    timeout = 'arguments.timeout = { kind = "output", range = [0.5, 1.0] }'
    call = "robot.write('home', None); robot.write('no such command', 3)"
    for index, expected in enumerate(([0.5, 1.0], [1.0, 0.5])):
        stage = make_stage(ROBOT, program(call), vocabulary("write", "node", timeout))
        result, _ = stage.mutated("opposite", "timeout", index=index)
        assert [row[2] for row in result] == expected


def test_a_skipped_write_leaves_the_others_alone(make_stage: Make) -> None:
    call = "robot.write('ns=2;s=Arm.X', 1.5); robot.write('ns=2;s=Grip', True)"
    stage = make_stage(ROBOT, program(call), vocabulary("write", "node"))
    assert stage.mutated("skip", index=0, idle=True)[0] == [("ns=2;s=Grip", True, 1.0)]


@pytest.mark.parametrize(
    ("target", "message", "call"),
    [
        ("write", "node", "robot.write('unknown', 1.5)"),
        ("write", "node", "robot.write(None, 1.5)"),
        ("Node.write_value", "self.request", "robot.Node('ns=2;s=Arm.X').write_value(1.5)"),
    ],
)
def test_a_command_that_no_pattern_takes_is_left_alone(
    make_stage: Make, target: str, message: str, call: str
) -> None:
    stage = make_stage(ROBOT, program(call), vocabulary(target, message))
    stage.run(stage.session())
    assert [seen.pattern for seen in stage.sites()] == [None]
    assert not problems(stage)


def problems(stage: Stage) -> list[Problem]:
    return [line for line in stage.writer.lines if isinstance(line, Problem)]


@pytest.mark.parametrize(
    ("target", "message", "call", "key", "words"),
    [
        ("Node.write_value", "self.nam", "robot.Node('x').write_value(1)", "message", ["no .nam", "'.name'"]),
        ("send", "request.nod", "robot.send(robot.Request('x', 1))", "message", ["no .nod", "'.node'"]),
        ("write", "nod", "robot.write('x', 1)", "message", ["no argument 'nod'"]),
        ("write", "node", "robot.write('x', 1)", "arguments.valu", ["no argument 'valu'"]),
    ],
)
def test_what_does_not_exist_is_a_problem(
    make_stage: Make, target: str, message: str, call: str, key: str, words: list[str]
) -> None:
    patterns = NODES.replace("arguments.value", key) if key.startswith("arguments") else NODES
    stage = make_stage(ROBOT, program(call), vocabulary(target, message, patterns=patterns))
    session = stage.session()
    stage.run(session)
    session.inspect_targets()
    assert any(
        problem.key == key and all(word in problem.text for word in words) for problem in problems(stage)
    )


def test_the_text_of_an_object_cannot_be_changed(make_stage: Make) -> None:
    patterns = f'patterns = [{{ text = "x/{{n:g}}", {X}, mode = "to" }}]\n'
    call = "robot.write(robot.Name('x/1'), 1.5)"
    stage = make_stage(ROBOT, program(call), vocabulary("write", "node", patterns=patterns))
    stage.run(stage.session())
    (problem,) = problems(stage)
    assert (problem.key, "is a Name, whose text cannot be changed" in problem.text) == ("message", True)


def moving(target: str, mode: str, *lines: str) -> str:
    text = f'[[operation]]\ncall = "robot:Arm.{target}"\narguments.dx = {{ {X}, mode = {mode} }}\n'
    text += 'current = "robot:Arm.where"\n' + "\n".join(lines)
    return (
        text
        + '\n[[operation]]\ncall = "robot:Arm.where"\nresult."[0]" = {'
        + 'kind = "position", axis = "x", unit = "m" }\n'
    )


RELATIVE = '{ argument = "relative", true = "by", false = "to" }'
FRAME = '{ argument = "frame", TOOL = "by", BASE = "to" }'


@pytest.mark.parametrize(
    ("target", "mode", "call", "case", "expected"),
    [
        ("go", RELATIVE, "go(1.0)", "relative=true", 0.75),
        ("go", RELATIVE, "go(1.0, True)", "relative=true", 0.75),
        ("go", RELATIVE, "go(1.0, relative=1)", "relative=true", 0.75),
        ("go", RELATIVE, "go(1.0, False)", "relative=false", 1.25),
        ("go", RELATIVE, "go(dx=1.0, relative=False)", "relative=false", 1.25),
        ("turn", FRAME, "turn(1.0, robot.Frame.TOOL)", "frame=TOOL", 0.75),
        ("turn", FRAME, "turn(1.0, 'BASE')", "frame=BASE", 1.25),
        ("turn", '{ argument = "frame", 1 = "by", none = "to" }', "turn(1.0, None)", "frame=none", 1.25),
    ],
)
def test_an_argument_decides_whether_a_motion_is_relative(
    make_stage: Make, target: str, mode: str, call: str, case: str, expected: float
) -> None:
    stage = make_stage(ROBOT, program(f"robot.Arm().{call}"), moving(target, mode))
    (found,), activation = stage.mutated("by-to", "dx")
    assert found[0] == expected
    assert activation.mutant.pattern == case
    assert activation.mutant.id.endswith(f":{case}/dx:by-to")
    stage = make_stage(ROBOT, program(f"robot.Arm().{call}"), moving(target, mode))
    assert stage.mutated("reverse", "dx")[0][0][0] == -1.0


def test_one_site_with_both_modes_has_a_mutant_for_each(make_stage: Make) -> None:
    call = "for relative in (True, False): robot.Arm().go(1.0, relative)"
    for index, expected in enumerate(([0.75, 1.0], [1.0, 1.25])):
        stage = make_stage(ROBOT, program(call), moving("go", RELATIVE))
        result, activation = stage.mutated("by-to", "dx", index=index)
        assert [dx for dx, _ in result] == expected
        assert (activation.activity.hits, activation.activity.acted) == (1, 1)


def test_the_opposite_of_an_operation_with_cases_is_its_opposite(make_stage: Make) -> None:
    text = moving("go", RELATIVE, 'opposite = "robot:Arm.turn"')
    text += f'[[operation]]\ncall = "robot:Arm.turn"\narguments.dx = {{ {X}, mode = "by" }}\n'
    robot = ROBOT.replace("def turn(self, dx, frame):", "def turn(self, dx, frame=None):")
    stage = make_stage(robot, program("robot.Arm().go(1.0)"), text)
    assert stage.mutated("opposite")[0] == [(1.0, None)]


def test_a_value_that_the_mode_does_not_mention_is_a_problem(make_stage: Make) -> None:
    stage = make_stage(ROBOT, program("robot.Arm().go(1.0, 'perhaps')"), moving("go", RELATIVE))
    stage.run(stage.session())
    (problem,) = problems(stage)
    assert problem.key == "mode"
    assert problem.text == "relative is perhaps, which `mode` does not list; it lists true, false"


def test_a_text_command_may_have_a_mode_that_another_argument_decides(make_stage: Make) -> None:
    mode = '{ argument = "value", true = "by", false = "to" }'
    patterns = f'patterns = [{{ text = "x/{{n:g}}", {X}, mode = {mode} }}]\n'
    stage = make_stage(
        ROBOT, program("robot.write('x/1', False)"), vocabulary("write", "node", patterns=patterns)
    )
    found: tuple[Any, MutatedSite] = stage.mutated("reverse", "n")
    assert found[0] == [("x/-1", False, 1.0)]
    assert found[1].mutant.pattern == "x/{n:g} [value=false]"
    assert found[1].mutant.pattern_name == "x/{n} [value=false]"
