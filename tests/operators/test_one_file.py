"""A new operator is one file: dropped into a copy of the package, with nothing else edited."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.campaign.project import write_project
from tests.package_copy import copied, mutants, python

#: comes in two sizes; acts on written values
OFFSET = """
    from __future__ import annotations

    from typing import ClassVar

    from mutabot.model import Kind, Operation, Path, Quantity
    from mutabot.operators.operator import Example, Subject

    from ._values import WrittenValueOperator

    _DX = Quantity("dx", Path("dx"), Kind.TRANSLATION, "x", "m")
    _MOVE = Operation("robot:Arm.move_by", (_DX,))


    class BitOff(WrittenValueOperator):
        name = "bit-off"
        summary = "A translation goes a bit too far."
        examples: ClassVar = (
            Example(Subject(_MOVE, quantity=_DX, magnitude=0.5), {"dx": 1.0}, performed=({"dx": 1.5},)),
        )

        def fits(self, quantity):
            return quantity.kind is Kind.TRANSLATION

        def magnitudes(self, quantity):
            return (quantity.from_unit(0.001, "m"), quantity.from_unit(0.5, "m"))

        def change(self, subject, value, random):
            return value + subject.magnitude
    """
#: acts on program text
ZERO = """
    import libcst as cst

    from mutabot_source.operator import ClassicalOperator, Draft, Example


    class Zero(ClassicalOperator):
        name = "CZR"
        summary = "A constant is zero."
        examples = (Example("x = 2\\n", ("x = 0\\n",)), Example("x = y\\n"))

        def drafts(self, node, around):
            if isinstance(node, cst.Float):
                yield Draft("", ("0.0",))
    """
MISSION = """
    def run(arm):
        arm.move_by(0.25)
    """
TESTS = """
    import mission
    from robot import Arm

    def test_it_moves():
        arm = Arm()
        mission.run(arm)
        assert abs(arm.x - 0.25) < 0.01
    """


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a copy of the package, into which two files were dropped."""
    dropped = {"operators/robot/bit_off.py": OFFSET, "classical/operators/zero.py": ZERO}
    return copied(tmp_path_factory.mktemp("site"), dropped)


def of_both_families(site: Path, folder: Path, *arguments: str) -> dict[str, Any]:
    found = mutants(site, folder, *arguments, "--family", "robot,classical")
    return {name.removeprefix("mission.py:run:"): one for name, one in found.items()}


def test_both_come_last_in_the_plan_and_the_others_keep_their_order(site: Path, tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS)
    found = of_both_families(site, tmp_path, "list")
    names = [one["operator"] for one in found.values()]
    assert [*dict.fromkeys(names)] == ["reverse", "skip", "repeat", "bit-off", "BSR", "UOI", "CZR"]
    assert {one["family"] for one in found.values() if one["operator"] == "bit-off"} == {"robot"}
    assert {one["family"] for one in found.values() if one["operator"] == "CZR"} == {"classical"}


@pytest.mark.parametrize("engine", ["branch", "replay"])
def test_both_get_verdicts_from_both_engines(engine: str, site: Path, tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS)
    only = ("--only", "bit-off", "--only", "CZR", "--engine", engine, "-o", "repeats=false")
    found = of_both_families(site, tmp_path, "run", *only)
    verdicts = {name: one["rounds"][0]["verdict"] for name, one in found.items()}
    assert verdicts == {
        "arm.move_by#1:dx:bit-off=0.001": "survived",
        "arm.move_by#1:dx:bit-off=0.5": "killed",
        "0.25#1:CZR": "killed",
    }
    assert {one["rounds"][0]["engine"] for one in found.values()} == {engine}


@pytest.mark.parametrize(
    ("page", "before", "name"),
    [("make_docs", "misread", "bit-off"), ("make_classical_page", "swap-characters", "CZR")],
)
def test_both_have_the_last_section_in_the_documentation(
    page: str, before: str, name: str, site: Path
) -> None:
    text = python(site, "-c", f"import {page}; print({page}.page())")
    assert 0 < text.index(f"\n## {before}\n") < text.index(f"\n## {name}\n")
