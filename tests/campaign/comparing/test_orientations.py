"""Orientations are compared as orientations, in probes and in what the program sends and reads."""

from __future__ import annotations

import math
from pathlib import Path as Folder
from typing import Any

import pytest

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.vocabulary_fit import refuse_unfit
from mutabot.campaign.comparison import OTHER_WORLD, Difference, Observation, TraceCall, compare
from mutabot.errors import ConfigurationError
from mutabot.model import Kind, Mode, Operation, Path, Probe, Quantity, Role, Site, Span, Vocabulary
from mutabot.model.events import TestEnd
from mutabot.model.mutant import Place
from mutabot.original import Hit
from tests.campaign.project import CONFIGURATION, REPLAY, run, write_project

TARGET = "cell:Arm.tool"
ROTATION_VECTOR = {"kind": Kind.ROTATION_VECTOR, "unit": "rad"}
DEGREES = {"kind": Kind.EULER, "unit": "deg", "order": "xyz"}
QUATERNION = {"kind": Kind.QUATERNION, "order": "xyzw"}


def probe(path: str, **meaning: Any) -> Probe:
    quantity = Quantity(path or "result", Path.parse(path, rooted=False), **meaning)
    return Probe(TARGET, tolerance=0.001, result=(quantity,))


def seen(values: Any, path: str = "") -> Observation:
    parts = values.items() if isinstance(values, dict) else ((f"[{i}]", v) for i, v in enumerate(values))
    return Observation(probes={f"{TARGET}{path}{name}": value for name, value in parts})


@pytest.mark.parametrize(
    ("probe_of_turn", "before", "after"),
    [
        (probe("", **ROTATION_VECTOR), [0.0, math.pi, 0.0], [0.0, -math.pi, 0.0]),
        (probe("", **DEGREES), [180.0, 0.0, 180.0], [0.0, 180.0, 0.0]),
        (probe("", **QUATERNION), [0.5, 0.5, 0.5, 0.5], [-0.5, -0.5, -0.5, -0.5]),
        (probe("[1]", kind=Kind.ORIENTATION, axis="z", unit="deg"), [7.0, 180.0], [7.0, -180.0]),
    ],
)
def test_the_same_orientation_written_otherwise_is_no_difference(
    probe_of_turn: Probe, before: Any, after: Any
) -> None:
    found = compare(seen(before), seen(after), [probe_of_turn])
    assert found.indistinguishable
    assert found.distance == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    ("probe_of_turn", "before", "after", "line"),
    [
        (
            probe("[3:6]", **ROTATION_VECTOR),
            [1.0, 2.0, 3.0, 0.0, math.pi - 0.1, 0.0],
            [1.0, 2.0, 3.0, 0.0, 0.1 - math.pi, 0.0],
            "Arm.tool[3:6]: (0, -3.042, 0) instead of (0, 3.042, 0) (turned by 0.2 rad)",
        ),
        (
            probe("[0]", kind=Kind.ORIENTATION, axis="z", unit="deg"),
            [179.0],
            [-179.0],
            "Arm.tool[0]: -179 instead of 179 (turned by 2 deg)",
        ),
    ],
)
def test_the_distance_of_orientations_is_the_angle_between_them(
    probe_of_turn: Probe, before: Any, after: Any, line: str
) -> None:
    found = compare(seen(before), seen(after), [probe_of_turn])
    assert found.divergence == (line,)
    assert found.distance == pytest.approx(2.0 / 0.5 if probe_of_turn.result[0].unit == "deg" else 0.2 / 0.01)


def test_what_lies_beside_an_orientation_is_compared_as_ever() -> None:
    turning = probe("[3:6]", **ROTATION_VECTOR)
    before, after = [0.0, 0.0, 0.0, 0.0, math.pi, 0.0], [0.0, 0.5, 0.0, 0.0, -math.pi, 0.0]
    found = compare(seen(before), seen(after), [turning])
    assert found.distance == pytest.approx(500.0)
    assert found.divergence == ("Arm.tool[1]: 0.5 instead of 0 (off by 0.5)",)


def test_the_parts_of_an_orientation_may_have_names() -> None:
    turning = probe(".turn", **QUATERNION)
    before = {".turn.w": 1.0, ".turn.x": 0.0, ".turn.y": 0.0, ".turn.z": 0.0, ".x": 1.0}
    after = {**before, ".turn.w": -1.0}
    assert compare(seen(before), seen(after), [turning]).indistinguishable
    assert not compare(seen(before), seen({**after, ".x": 2.0}), [turning]).indistinguishable


def test_each_object_of_a_probe_has_its_own_orientation() -> None:
    turning = probe("", **ROTATION_VECTOR)
    before, after = seen([0.0, math.pi, 0.0], "#2"), seen([0.0, -math.pi, 0.0], "#2")
    assert compare(before, after, [turning]).indistinguishable
    assert not compare(before, seen([0.0, 1.0, 0.0], "#2"), [turning]).indistinguishable


@pytest.mark.parametrize("after", [[0.0, 0.0], ["a", 0.0, 0.0], [math.nan, 0.0, 0.0]])
def test_what_is_no_orientation_is_never_equal_to_one(after: Any) -> None:
    found = compare(seen([0.0, 0.0, 0.0]), seen(after), [probe("", **ROTATION_VECTOR)])
    assert (found.indistinguishable, found.distance) == (False, OTHER_WORLD)


def traced(quantity: Quantity, before: Any, after: Any) -> Difference:
    operation = Operation("robot:turn", (quantity,), ())
    events = [
        Observation([TraceCall("a", {quantity.name: value}, {}, ("robot:turn", None))])
        for value in (before, after)
    ]
    return compare(*events, (), (operation,))


def turn(kind: Kind, axis: str | None, mode: Mode | None, unit: str = "deg") -> Quantity:
    return Quantity("a", Path("a"), kind, axis, unit, None, mode)


@pytest.mark.parametrize(
    ("quantity", "before", "after", "same"),
    [
        (turn(Kind.ROTATION, "z", Mode.TO), 180.0, -180.0, True),
        (turn(Kind.ROTATION, "z", Mode.TO), 180.0, -179.0, False),
        (turn(Kind.ROTATION, "z", Mode.BY), 360.0, 0.0, False),
        (turn(Kind.ROTATION, "j6", Mode.TO), 180.0, -180.0, False),
        (turn(Kind.ORIENTATION, "z", None), 180.0, -180.0, True),
        (turn(Kind.ANGLE, None, None), 10.0, 370.0, True),
        (turn(Kind.ANGLE, "j6", None), 10.0, 370.0, False),
        (turn(Kind.ROTATION_VECTOR, None, None, "rad"), [0.0, math.pi, 0.0], [0.0, -math.pi, 0.0], True),
        (turn(Kind.ROTATION_VECTOR, None, None, "rad"), [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], False),
        (turn(Kind.POSITION, "x", None, "m"), 6.0, 6.0 - math.tau, False),
    ],
)
def test_values_in_the_trace_are_compared_by_what_they_mean(
    quantity: Quantity, before: Any, after: Any, same: bool
) -> None:
    assert traced(quantity, before, after).indistinguishable is same


@pytest.mark.parametrize(
    ("quantity", "before", "after", "text"),
    [
        (turn(Kind.ROTATION, "z", Mode.TO), 179.0, -91.0, "-91 instead of 179 (turned by 90 deg)"),
        (turn(Kind.ROTATION, "z", Mode.BY), 179.0, -91.0, "-91 instead of 179 (off by 270)"),
        (
            turn(Kind.ROTATION_VECTOR, None, None, "rad"),
            [0.0, 3.14, 0.0],
            [0.0, -3.14, 0.0],
            "(0, -3.14, 0) instead of (0, 3.14, 0) (turned by 0.00319 rad)",
        ),
    ],
)
def test_a_difference_of_angles_in_the_trace_is_described_as_one(
    quantity: Quantity, before: Any, after: Any, text: str
) -> None:
    assert traced(quantity, before, after).divergence == (f"call 1, a: wrote a {text}",)


ROBOT = """
    from math import pi

    class Arm:
        def __init__(self):
            self.turned = [0.0, 0.0, 0.0]

        def see(self, what):
            return {"box": pi, "lid": 0.5}[what]

        def turn_to(self, ry):
            self.turned = [0.0, ry, 0.0]
"""
MISSION = """
    def turn_to_box(arm):
        arm.turn_to(arm.see("box"))

    def turn_to_lid(arm):
        arm.turn_to(arm.see("lid"))
"""
TESTS = """
    import pytest
    import mission, robot

    @pytest.mark.parametrize("what", ["box", "lid"])
    def test_it(what):
        getattr(mission, f"turn_to_{what}")(robot.Arm())
"""
VOCABULARY = """
    [[operation]]
    call = "robot:Arm.see"
    result = { kind = "orientation", axis = "y", unit = "rad" }

    [[operation]]
    call = "robot:Arm.turn_to"
    arguments.ry = { kind = "rotation", axis = "y", unit = "rad", mode = "to" }

    [[probe]]
    call = "robot:Arm.turned"
    tolerance = 0.001
    result = { kind = "rotation_vector", unit = "rad" }
"""


@pytest.mark.parametrize("engine", ["fork", REPLAY])
def test_a_survivor_that_is_turned_as_the_original_is_indistinguishable(
    engine: str, tmp_path: Folder
) -> None:
    folder = write_project(
        tmp_path, MISSION, TESTS, robot=ROBOT, vocabulary=VOCABULARY, configuration=CONFIGURATION
    )
    found = run(folder, engine=engine, only=("negate",), rounds=1)
    box, lid = (found[f"mission.py:turn_to_{what}:arm.see#1:result:negate"] for what in ("box", "lid"))
    assert box.indistinguishable
    assert box.distance == pytest.approx(0.0, abs=1e-6)
    assert not lid.indistinguishable
    assert lid.distance == pytest.approx(100.0)
    assert lid.divergence[0] == "Arm.turned: (0, -0.5, 0) instead of (0, 0.5, 0) (turned by 1 rad)"


def recorded(value: Any) -> Baseline:
    site = Site(Span("mission.py", 1, 0, 1, 1, "run"), "turn", 1, Role.PROGRAM)
    end = TestEnd("test", "passed", probes={f"{TARGET}[{i}]": v for i, v in enumerate(value)})
    return Baseline(hits={Place(site, "robot:turn"): [Hit({"a": value}, {})]}, ends={(0, "test"): end})


@pytest.mark.parametrize(
    ("vocabulary", "value", "told"),
    [
        (
            Vocabulary(
                (Operation("robot:turn", (turn(Kind.ROTATION_VECTOR, None, None, "rad"),), source="here"),)
            ),
            [1, 2],
            "arguments.a: rotation_vector needs three numbers, and the value is (1, 2)",
        ),
        (
            Vocabulary(probes=(probe("", **QUATERNION),)),
            [0.0, 0.0, 0.0],
            "result.result: quaternion needs four numbers, not all zero, and the value is (0, 0, 0)",
        ),
        (
            Vocabulary(probes=(probe(".turn", **QUATERNION),)),
            [0.0, 0.0, 0.0, 1.0],
            "result..turn: the probe never reads such a part",
        ),
    ],
)
def test_an_orientation_that_the_original_never_has_is_refused(
    vocabulary: Vocabulary, value: Any, told: str
) -> None:
    with pytest.raises(ConfigurationError) as caught:
        refuse_unfit(recorded(value), vocabulary)
    assert told in str(caught.value)


@pytest.mark.parametrize("value", [[0.0, 0.0, 1.0], [0.5, 0.5, 0.5, 0.5]])
def test_an_orientation_that_the_original_has_is_taken(value: Any) -> None:
    quantity = turn(Kind.ROTATION_VECTOR, None, None, "rad") if len(value) == 3 else None
    operations = (Operation("robot:turn", (quantity,)),) if quantity is not None else ()
    probes = () if quantity is not None else (probe("", **QUATERNION),)
    refuse_unfit(recorded(value), Vocabulary(operations, probes=probes))
