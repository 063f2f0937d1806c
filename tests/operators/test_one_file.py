"""A new operator is one file: dropped into a copy of the package, with nothing else edited."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from tests.campaign.project import write_project
from tests.package_copy import copied, mutants, python

pytestmark = pytest.mark.needs("source")

#: two operators; one comes in two sizes and acts on written values, the other acts on commands
TOO_MUCH = """
    from __future__ import annotations

    from typing import ClassVar

    from mutabot.api.faults import CommandOperator, Example, Magnitudes, Subject, ValueOperator
    from mutabot.api.values import Kind, Operation

    _MOVE = Operation.writing("robot:Arm.move_by", "dx", Kind.TRANSLATION, axis="x", unit="m")


    class BitOff(ValueOperator):
        name = "bit-off"
        summary = "A translation goes a bit too far."
        kinds = frozenset({Kind.TRANSLATION})
        of_read = False
        examples: ClassVar = (Example.changed(_MOVE, 1.0, 1.5, size=("", 0.5, None)),)

        def magnitudes(self, quantity):
            return Magnitudes(None, (quantity.from_unit(0.001, "m"), quantity.from_unit(0.5, "m")))

        def change(self, value, context):
            return value + context.subject.magnitude


    class Thrice(CommandOperator):
        name = "thrice"
        summary = "A command is carried out three times."
        fault = "do it three times"
        examples: ClassVar = (Example(Subject(Operation("robot:Arm.home")), performed=({}, {}, {})),)

        async def mutated(self, call, proceed, context):
            await proceed(call)
            await proceed(call)
            return await proceed(call)
    """
#: acts on program text
ZERO = """
    import ast

    from mutabot_source.operator import ConventionalOperator, Draft, TextExample


    class Zero(ConventionalOperator):
        name = "CZR"
        summary = "A constant is zero."
        examples = (TextExample("x = 2\\n", ("x = 0\\n",)), TextExample("x = y\\n"))

        def drafts(self, node, around):
            if isinstance(node, ast.Constant) and isinstance(node.value, float):
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
    """A folder with copies of two packages, into each of which a file was dropped."""
    folder = tmp_path_factory.mktemp("site")
    copied(folder, {"operators/zero.py": ZERO}, of=import_module("mutabot_source"))
    return copied(folder, {"operators/kinds/too_much.py": TOO_MUCH})


def of_both_families(site: Path, folder: Path, *arguments: str) -> dict[str, Any]:
    found = mutants(site, folder, *arguments, "--family", "robot,conventional")
    return {name.removeprefix("mission.py:run:"): value for name, value in found.items()}


def test_both_come_last_in_the_plan_and_the_others_keep_their_order(site: Path, tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS)
    found = of_both_families(site, tmp_path, "list")
    names = [mutant["operator"] for mutant in found.values()]
    assert [*dict.fromkeys(names)] == ["reverse", "skip", "repeat", "bit-off", "thrice", "BSR", "UOI", "CZR"]
    assert {mutant["family"] for mutant in found.values() if mutant["operator"] == "bit-off"} == {"robot"}
    assert {mutant["family"] for mutant in found.values() if mutant["operator"] == "CZR"} == {"conventional"}


def test_both_get_verdicts(site: Path, tmp_path: Path) -> None:
    write_project(tmp_path, MISSION, TESTS)
    only = (word for name in ("bit-off", "thrice", "CZR") for word in ("--only", name))
    found = of_both_families(site, tmp_path, "run", *only, "-o", "repeats=false")
    verdicts = {name: mutant["rounds"][0]["verdict"] for name, mutant in found.items()}
    assert verdicts == {
        "arm.move_by#1:dx:bit-off=0.001": "survived",
        "arm.move_by#1:dx:bit-off=0.5": "killed",
        "arm.move_by#1:call:thrice": "killed",
        "0.25#1:CZR": "killed",
    }


@pytest.mark.parametrize(
    ("page", "before", "name"),
    [("make_docs", "bit-off", "thrice"), ("make_conventional_page", "swap-characters", "CZR")],
)
def test_both_have_the_last_section_in_the_documentation(
    page: str, before: str, name: str, site: Path
) -> None:
    text = python(site, "-c", f"import {page}; print({page}.page())")
    headings = re.findall(r"^##+ (.*)$", text, re.MULTILINE)
    assert headings.index(before) < headings.index(name)
