"""Paths into lists and other containers, read and written; what the program gave stays as it was."""

from __future__ import annotations

import math

import pytest

from mutabot.errors import PathError
from mutabot.model import Path
from mutabot.model.events import Problem
from tests.runtime.stage import Make

ROBOT = """
    from array import array
    from collections import deque, namedtuple
    from dataclasses import dataclass
    from types import MappingProxyType, SimpleNamespace

    import numpy as np

    Joints = namedtuple("Joints", "a b")

    @dataclass(frozen=True)
    class Point:
        x: float

    class Parameter:
        \"\"\"As those of rclpy: what it holds can be read only.\"\"\"
        def __init__(self, name, value=None):
            self._name, self._value = name, value

        @property
        def name(self):
            return self._name

        @property
        def value(self):
            return self._value

    class Own(list):
        pass

    def send(positions):
        return positions

    def read(positions):
        return positions
"""
PROGRAM = """
    import copy
    import robot
    from robot import *

    def run():
        given = {given}
        before = copy.deepcopy(given)
        sent = robot.send(given)
        seen = robot.read(given)
        assert repr(plain(given)) == repr(plain(before)), "what the program gave was changed"
        return sent, seen

    def plain(value):
        value = value.tolist() if hasattr(value, "tolist") else value
        if isinstance(value, (list, tuple, deque)):
            return [plain(one) for one in value]
        return plain(vars(value)) if hasattr(value, "__dict__") else value
"""
VOCABULARY = """
[[operation]]
call = "robot:send"
arguments.positions."{path}" = {{ kind = "rotation", axis = "j1", unit = "rad", mode = "by" }}

[[operation]]
call = "robot:read"
result."{path}" = {{ kind = "angle", axis = "j1", unit = "rad" }}
"""


@pytest.mark.parametrize(
    ("given", "path"),
    [
        ("[0.25, 1.0]", "[0]"),
        ("[1.0, 0.25]", "[-1]"),
        ("(0.25, 1.0)", "[0]"),
        ("Joints(1.0, 0.25)", "[1]"),
        ("Own([0.25, 1.0])", "[0]"),
        ("deque([0.25, 1.0])", "[0]"),
        ("array('d', [0.25, 1.0])", "[0]"),
        ("array('f', [0.25, 1.0])", "[0]"),
        ("np.array([0.25, 1.0])", "[0]"),
        ("np.array([0.25, 1.0], dtype='float32')", "[0]"),
        ("np.array([[0.25, 1.0]])[0]", "[0]"),
        ("np.broadcast_to(0.25, 2)", "[0]"),
        ("[[1.0], [0.25, 1.0]]", "[1][0]"),
        ("((1.0, [0.25]),)", "[0][1][0]"),
        ("[np.array([1.0, 0.25])]", "[0][1]"),
        ("[Point(0.25), Point(1.0)]", "[0].x"),
        ("(SimpleNamespace(x=0.25),)", "[0].x"),
        ("[{'angle': 0.25}]", "[0]['angle']"),
        ("[Parameter('speed', value=0.25)]", "[0].value"),
        ("[Parameter('limits', value=[1.0, 0.25])]", "[0].value[1]"),
        ("[Parameter('limits', value=(1.0, 0.25))]", "[0].value[1]"),
    ],
)
def test_a_path_leads_into_a_container(make_stage: Make, given: str, path: str) -> None:
    stage = make_stage(ROBOT, PROGRAM.format(given=given), VOCABULARY.format(path=path))

    for operator, quantity, index in (("reverse", f"positions{path}", 0), ("negate", path, 1)):
        both, activation = stage.mutated(operator, quantity, index=index)
        assert activation.activity.acted == 1
        changed, original = both[index], both[1 - index]
        assert Path.parse(path, rooted=False).get(changed) == -0.25
        assert Path.parse(path, rooted=False).get(original) == 0.25
        assert type(changed) is type(original)
    assert not [line for line in stage.writer.lines if isinstance(line, Problem)]


@pytest.mark.needs("catalogue")
@pytest.mark.parametrize(
    ("given", "operator", "variant", "changed"),
    [
        ("array('i', [2, 1])", "deg-for-rad", "given-deg", math.degrees(2)),
        ("array('B', [2, 1])", "reverse", "", -2),
        ("np.array([2, 1])", "deg-for-rad", "given-deg", math.degrees(2)),
        ("np.array([2, 1], dtype='uint8')", "reverse", "", -2),
    ],
)
def test_an_array_of_whole_numbers_takes_what_it_could_not_hold(
    make_stage: Make, given: str, operator: str, variant: str, changed: float
) -> None:
    stage = make_stage(ROBOT, PROGRAM.format(given=given), VOCABULARY.format(path="[0]"))
    (sent, _), activation = stage.mutated(operator, "positions[0]", variant=variant)
    assert (activation.activity.acted, list(sent)) == (1, [pytest.approx(changed), 1])


def test_a_property_that_is_computed_cannot_be_replaced() -> None:
    class Twice:
        x = 1.0

        @property
        def value(self) -> float:
            return 2 * self.x

    with pytest.raises(PathError, match=r"cannot replace \.value of Twice"):
        Path.parse("[0].value", rooted=False).put([Twice()], 3.0)
