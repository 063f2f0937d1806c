"""Values that nobody reads have no reading mutants; what else is done to the same calls stays."""

from __future__ import annotations

from pathlib import Path
from textwrap import indent

import pytest

from mutabot.campaign.checking import PlannedCampaign, plan_only
from mutabot.families import CATALOGUE, GRADED, ROBOT
from tests.campaign.project import CONFIGURATION, Quiet, request_for, write_project

ROBOT_PY = """
    import library

    class NoImage(Exception): ...

    class Arm:
        def where(self):
            return 0.5

        def step(self, dx):
            return 0.5

        async def later(self):
            return 0.5

        def look(self):
            return 0.5

        def through(self):
            return library.twice(self)
"""
LIBRARY = """
    def twice(arm):
        return 2 * arm.where()
"""
MISSION = """
    import contextlib

    async def run(arm):
        arm.where()
        (
            arm.where()
        )
        await arm.later()
        arm.step(0.25)
        arm.look()
        arm.through()
        _ = arm.where()
        for dx in range(2): arm.where()
        arm.where() or None
        [arm.where()]
        with contextlib.suppress(arm.where() and ValueError): ...
        (lambda: arm.where())()
        seen = await arm.later()
        return arm.where(), seen
"""
TESTS = """
    import asyncio
    import mission, robot

    def test_it():
        asyncio.run(mission.run(robot.Arm()))
"""
READING = 'result = { kind = "position", axis = "x", unit = "m" }'
VOCABULARY = f"""
    [[operation]]
    call = "robot:Arm.where"
    {READING}

    [[operation]]
    call = "robot:Arm.later"
    {READING}

    [[operation]]
    call = "robot:Arm.step"
    arguments.dx = {{ kind = "translation", axis = "x", unit = "m", mode = "by" }}
    {READING}

    [[operation]]
    call = "robot:Arm.look"
    result = {{ kind = "position", axis = "x", unit = "m", missing = "robot:NoImage" }}
"""
WHY = "the result of the call is not used"


@pytest.mark.needs("catalogue")
def test_readings_of_calls_whose_result_is_not_used_are_left_out(tmp_path: Path) -> None:
    folder = write_project(
        tmp_path, MISSION, TESTS, robot=ROBOT_PY, vocabulary=VOCABULARY, more={"library.py": LIBRARY},
        configuration=CONFIGURATION + "    rounds = 1\n",
    )  # fmt: skip
    families = (ROBOT, CATALOGUE, GRADED)
    planned = plan_only(request_for(folder, families=families, rounds=1), Quiet())
    mutants, left_out = planned.mutants, planned.left_out
    unread = [omission.id.split(":")[2:] for omission in left_out if omission.reason == WHY]
    assert [site for site, *_, operator in unread if operator == "negate"] == [
        "arm.where#1", "arm.where#2", "arm.later#1", "arm.step#1", "arm.look#1", "arm.where#3", "arm.where#4",
    ]  # fmt: skip
    assert {operator.partition("=")[0] for *_, operator in unread} >= {
        "negate",
        "noise",
        "offset",
        "spike",
    }
    kept = {(mutant.site.text, mutant.site.occurrence) for mutant in mutants if mutant.operator == "negate"}
    assert kept == {
        ("arm.through", 1), ("arm.where", 5), ("arm.where", 6), ("arm.where", 7),
        ("arm.where", 8), ("arm.later", 2), ("arm.where", 9),
    }  # fmt: skip
    others = {
        mutant.operator for mutant in mutants if (mutant.site.text, mutant.site.occurrence) == ("arm.step", 1)
    }
    assert {"reverse", "skip", "repeat"} <= others
    assert [mutant.operator for mutant in mutants if mutant.site.text == "arm.look"] == ["dropout"]


def planned_for(folder: Path, body: str, robot: str, vocabulary: str) -> PlannedCampaign:
    mission = "def run(arm):\n" + indent(body, "    ") + "\n"
    tests = "import mission, robot\n\ndef test_it():\n    mission.run(robot.Arm())\n"
    write_project(folder, mission, tests, robot=robot, vocabulary=vocabulary)
    return plan_only(request_for(folder, rounds=1), Quiet())


POSES = """
    from dataclasses import dataclass

    @dataclass
    class Pose:
        x: float = 1.0
        y: float = 2.0
        z: float = 3.0

        @property
        def far(self):
            return self.x + self.y

    class Arm:
        def pose(self):
            return Pose()

        def point(self):
            return 1.0, 2.0, 3.0
"""
OF_POSES = """
    [[operation]]
    call = "robot:Arm.pose"
    result.".x" = { kind = "position", axis = "x", unit = "m" }
    result.".y" = { kind = "position", axis = "y", unit = "m" }
    result.".z" = { kind = "position", axis = "z", unit = "m" }

    [[operation]]
    call = "robot:Arm.point"
    result."[0]" = { kind = "position", axis = "x", unit = "m" }
    result."[1]" = { kind = "position", axis = "y", unit = "m" }
    result."[2]" = { kind = "position", axis = "z", unit = "m" }
"""


NESTED = """
    class Arm:
        def state(self):
            return {"pose": ((1.0, 2.0), (3.0, 4.0)), "speed": [5.0, 6.0]}

        def pair(self):
            return [1.0, 2.0], [3.0, 4.0]
"""
OF_NESTED = """
    [[operation]]
    call = "robot:Arm.state"
    result."['pose'][0][0]" = { kind = "position", axis = "x", unit = "m" }
    result."['pose'][0][1]" = { kind = "position", axis = "y", unit = "m" }
    result."['speed'][0]" = { kind = "distance", unit = "m", noise = 0.1 }

    [[operation]]
    call = "robot:Arm.pair"
    result."[0][0]" = { kind = "position", axis = "x", unit = "m" }
    result."[0][1]" = { kind = "position", axis = "y", unit = "m" }
    result."[1][0]" = { kind = "distance", unit = "m", noise = 0.1 }
"""


@pytest.mark.parametrize(
    ("body", "read"),
    [
        ("return arm.state()['pose'][0][1]", {"['pose'][0][1]"}),
        ("state = arm.state()\nreturn state['pose'][0]", {"['pose'][0][0]", "['pose'][0][1]"}),
        (
            "state = arm.state()\nreturn state['pose'][1]",
            {"['pose'][0][0]", "['pose'][0][1]", "['speed'][0]"},
        ),
        ("state = arm.state()\nreturn state['speed'].copy()", {"['speed'][0]"}),
        ("place, _ = arm.pair()\nreturn place[1]", {"[0][1]"}),
        ("place, speed = arm.pair()\nreturn place, speed[0]", {"[0][0]", "[0][1]", "[1][0]"}),
        ("place, (vx, vy) = arm.pair()\nreturn place[0]", {"[0][0]", "[1][0]"}),
    ],
)
def test_parts_of_parts_are_told_apart_as_far_as_the_text_shows_them(
    tmp_path: Path, body: str, read: set[str]
) -> None:
    planned = planned_for(tmp_path, body, NESTED, OF_NESTED)
    assert {mutant.quantity for mutant in planned.mutants if mutant.operator == "noise"} == read


@pytest.mark.parametrize(
    ("body", "read"),
    [
        ("return arm.pose().z", "z"),
        ("pose = arm.pose()\nreturn pose.z + pose.x", "xz"),
        ("pose: object = arm.pose()\nreturn [pose.z for _ in range(2)]", "z"),
        ("pose = arm.pose()\nreturn (lambda: pose.y)()", "y"),
        ("x, _, z = arm.point()\nreturn x", "x"),
        ("[x, y, z] = arm.point()\ny += 1\nreturn z", "yz"),
        ("return arm.point()[2]", "z"),
        ("point = arm.point()\nreturn point[0]", "x"),
        # whoever has the whole, or may have it, reads all
        ("pose = arm.pose()\nreturn pose.z, pose", "xyz"),
        ("pose = arm.pose()\nreturn pose.far", "xyz"),
        ("pose = arm.pose()\nreturn pose.__eq__(3), pose.z", "xyz"),
        ("pose = arm.pose()\nreturn pose.z, locals()", "xyz"),
        ("pose = arm.pose()\npose.x = 4.0\nreturn pose.z", "xyz"),
        ("pose = kept = arm.pose()\nreturn pose.z", "xyz"),
        ("global pose\npose = arm.pose()\nreturn pose.z", "xyz"),
        ("return arm.point()[-1], arm.pose().z", "xyzz"),
        ("point = arm.point()\nreturn point[:1], point[2]", "xyz"),
        ("_, _, _ = arm.point()", "xyz"),
        ("*_, z = arm.point()\nreturn z", "xyz"),
    ],
)
def test_parts_of_a_result_that_the_function_does_not_read_have_no_reading_mutants(
    tmp_path: Path, body: str, read: str
) -> None:
    planned = planned_for(tmp_path, body, POSES, OF_POSES)
    axes = {".x": "x", ".y": "y", ".z": "z", "[0]": "x", "[1]": "y", "[2]": "z"}
    kept = [mutant.quantity for mutant in planned.mutants if mutant.operator == "negate"]
    assert "".join(sorted(axes[part or ""] for part in kept)) == read
    assert all(
        omission.reason.startswith("only these parts of the result are read: ")
        for omission in planned.left_out
        if omission.id.endswith("negate")
    )
