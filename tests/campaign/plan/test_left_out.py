"""Each reason why mutants are left out has its own heading, and what nobody heeds is told with its place."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.campaign.checking import check, plan_only
from mutabot.errors import NothingToDoError
from mutabot.model import LeftOut, Moment
from mutabot.model.left_out import by_heading
from mutabot.model.quantity import holds_number
from mutabot.report.sections import skipped
from tests.campaign.project import Quiet, request_for, write_project

STILL = "would change nothing in the call (value 0 m)"
LEFT_OUT = [
    LeftOut("a", "", "no call raises in the baseline"),
    LeftOut("b", "", STILL),
    LeftOut("c", "", "no call raises in the baseline"),
    LeftOut("d", "", "would change nothing in any of 2 calls"),
]


def test_only_what_would_change_nothing_stands_under_that() -> None:
    found = by_heading(LEFT_OUT)
    assert {heading: [omission.id for omission in those] for heading, those in found.items()} == {
        "would change nothing": ["b", "d"], "no call raises in the baseline": ["a", "c"],
    }  # fmt: skip
    first, second = skipped(LEFT_OUT)
    assert (first.title, list(first.lines)) == ("2 mutants left out that would change nothing", [])
    assert (second.title, list(second.lines)) == (
        "2 mutants left out: no call raises in the baseline",
        ["`mutabot list --all` lists each, with its reason."],
    )


@pytest.mark.parametrize(
    ("value", "is_one"),
    [(1, True), (0.5, True), ([None, 2.0], True), ("1.5", True), ("<base.Vector3 object>", False),
     ("", False), (True, False), ({"opaque": "base:Vector3"}, False), ([], False)],
)  # fmt: skip
def test_what_holds_a_number(value: object, is_one: bool) -> None:
    assert holds_number(value) is is_one


MISSION = """
    class Speed:
        def __init__(self, y): self.y = y

    def run(base):
        base.drive(Speed(-0.1))
        return base.force()
    """
ROBOT = """
    class Base:
        def drive(self, speed): self.y = speed.y
        def force(self): return 3200.0
    """
TESTS = """
    import mission
    from robot import Base

    def test_run():
        assert mission.run(Base()) > 0
    """
DRIVE = """
    [[operation]]
    call = "robot:Base.drive"
    arguments.speed = { kind = "speed", unit = "m/s", axis = "y" }
    """
FORCE = """
    [[operation]]
    call = "robot:Base.force"
    result = { kind = "force", unit = "N", noise = 10 }
    """


def project(folder: Path, vocabulary: str) -> Path:
    return write_project(folder, MISSION, TESTS, robot=ROBOT, vocabulary=vocabulary)


def test_a_quantity_that_names_an_object_is_reported_with_its_place_and_what_to_do(tmp_path: Path) -> None:
    report = check(request_for(project(tmp_path, DRIVE), engine="fork", rounds=1), Quiet())
    (note,) = (line for line in report.lines if line.startswith("note "))
    assert "arguments.speed: speed is of mission:Speed, which is not plain data" in note
    assert "describe the part of it that is a number, such as speed.magnitude" in note
    reason = "the call passes no plain value here that can be replaced"
    assert report.data["left_out_because"] == {reason: 1}
    assert f"left out  1: {reason}" in report.lines


@pytest.mark.parametrize("number", ["10**400", "-10**5000", "Fraction(10**400, 3)"])
def test_a_number_beyond_floating_point_numbers_is_reported_and_left_out(tmp_path: Path, number: str) -> None:
    program = f"""
        from fractions import Fraction

        def run(base):
            base.drive({number})
            return 1
        """
    robot = "class Base:\n    def drive(self, speed): self.y = speed\n"
    folder = write_project(tmp_path, program, TESTS, robot=robot, vocabulary=DRIVE)
    report = check(request_for(folder, engine="fork", rounds=1), Quiet())
    (note,) = (line for line in report.lines if line.startswith("note "))
    assert "no floating-point number can stand for speed, so its value is left as it is" in note
    assert report.data["left_out_because"] == {"the call passes no plain value here that can be replaced": 1}


@pytest.mark.parametrize(
    ("answer", "path", "part"),
    [("3200 + 4j", ".imag", ".imag of complex"), ("[b'ab']", "[0][1]", "[1] of bytes")],
)
def test_a_part_that_cannot_be_replaced_is_reported_and_left_out(
    tmp_path: Path, answer: str, path: str, part: str
) -> None:
    robot = f"class Base:\n    def force(self): return {answer}\n"
    vocabulary = f"""
        [[operation]]
        call = "robot:Base.force"
        result."{path}" = {{ kind = "force", unit = "N" }}
        """
    program = "def run(base): return 1 if base.force() else 0\n"
    folder = write_project(tmp_path, program, TESTS, robot=robot, vocabulary=vocabulary)
    told = Quiet()
    with pytest.raises(NothingToDoError):
        plan_only(request_for(folder, engine="fork", rounds=1), told)
    assert any(f"{part} cannot be replaced, so the value is left as it is" in line for line in told.lines)


def test_noise_on_what_no_operator_adds_it_to_is_reported(tmp_path: Path) -> None:
    told = Quiet()
    request = request_for(project(tmp_path, FORCE), engine="fork", rounds=1)
    with pytest.raises(NothingToDoError, match=r"no operator of the families asked for \(robot\)"):
        plan_only(request, told)
    assert any("result.noise: noise is added to positions" in line for line in told.lines)


@pytest.mark.whole
def test_a_moment_or_demand_that_nobody_heeds_is_reported(tmp_path: Path) -> None:
    folder = project(tmp_path, DRIVE)
    file = folder / "mutabot.toml"
    file.write_text(file.read_text() + '[[demand]]\nquantity = "speed"\nnotice = "1 mm"\n')
    asked = request_for(folder, families=("robot", "conventional"), moments=(Moment.parse_any("once"),))
    notes = [line for line in check(asked, Quiet()).lines if line.startswith("note ")]
    assert any("when: mutants of conventional ignore it: only" in line for line in notes), notes
    assert any("demand: no mutant of offset is what it speaks of" in line for line in notes), notes


def test_an_object_with_coordinates_is_reported_with_one_of_them(tmp_path: Path) -> None:
    folder = project(tmp_path, DRIVE)
    mission = (folder / "mission.py").read_text().replace("class Speed:", "class Speed:\n    y = 0.0")
    (folder / "mission.py").write_text(mission)
    report = check(request_for(folder, engine="fork", rounds=1), Quiet())
    (note,) = (line for line in report.lines if line.startswith("note "))
    assert "a number, such as speed.y" in note
