"""The third judge edits as people would, knows nothing of mutabot, and says what plain pytest says."""

from __future__ import annotations

import json
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from re import RegexFlag
from textwrap import dedent
from typing import Any

import pytest

from mutabot.operators import names
from mutabot.operators import operator as operator_of

from .catalogue_editor import CatalogueEditor
from .editor import CannotWriteError, Facts, edits_for
from .judge import Judge
from .message_editor import edits_of
from .planted import noisy, other, with_argument

VOCABULARY = """
    refusals = ["robot:Refused"]

    [[operation]]
    call = "robot:Arm.move"
    arguments.dx = { kind = "translation", axis = "x", unit = "m", mode = "by" }
    current = "robot:Arm.where"

    [[operation]]
    call = "robot:Arm.turn"
    arguments.angle = { kind = "rotation", axis = "z", unit = "deg", mode = "to", range = [0, 360] }

    [[operation]]
    call = "robot:Arm.follow"
    arguments."path[1]" = { kind = "translation", axis = "x", unit = "m", mode = "to" }

    [[operation]]
    call = "robot:Arm.where"
    result = { kind = "position", axis = "x", unit = "m", noise = 2.0 }

    [[operation]]
    call = "robot:Arm.see"
    result.".colour" = { kind = "label", values = ["red", "blue", "grey"] }

    [[operation]]
    call = "robot:Arm.open"
    opposite = "robot:Arm.close"

    [[operation]]
    call = "robot:Arm.grip"
    arguments.closed = { kind = "output", values = [false, true] }

    [[operation]]
    call = "robot:Arm.send"
    message = "text"
    patterns = [
      { text = "lift/{h:g}", kind = "translation", axis = "z", unit = "cm", mode = "by", opposite = "drop/{h:g}" },
    ]
"""  # noqa: E501
ROBOT = """
    class Refused(Exception):
        pass

    class Arm:
        x = 0.0
        def move(self, dx):
            if dx > 5:
                raise Refused("too far")
            self.x += dx
        def turn(self, angle): pass
        def follow(self, path): pass
        def where(self): return self.x
        async def reach(self): return self.x
        def see(self): pass
        def open(self): pass
        def close(self): pass
        def grip(self, closed): pass
        def send(self, text): pass
"""
HINTS = """
    [idle]
    "robot:Arm.where" = "7.5"

    [current]
    "robot:Arm.move" = "SELF.where()"
"""


def project(folder: Path, mission: str, tests: str = "") -> Path:
    """A project with one program."""
    files = {
        "mission.py": mission, "robot.py": ROBOT, "robot.toml": VOCABULARY, "judge.toml": HINTS,
        "test_it.py": tests,
        "mutabot.toml": 'program = ["mission.py"]\nvocabulary = ["robot.toml"]\ntests = ["test_it.py"]',
        "pytest.ini": "[pytest]\npythonpath = .",
    }  # fmt: skip
    for name, text in files.items():
        (folder / name).write_text(dedent(text))
    return folder


def mutant(call: str, source: str, **facts: Any) -> dict[str, Any]:
    """What ``mutabot list --json`` says of a mutant of ``call`` in a one-line program."""
    start = source.index(call)
    span = {"line": 1, "column": start + 1, "end_line": 1, "end_column": start + len(call) + 1}
    defaults = {"id": "mission.py:x#1:call:y", "family": "robot", "file": "mission.py", "pattern": None,
                "quantity": None, "variant": "", "description": ""}  # fmt: skip
    return {**defaults, "span": span, **facts}


P = '__import__("_planted")'
EDITS = {
    "reverse": ("arm.move(0.5)", "Arm.move", "dx", "", "arm.move(-(0.5))"),
    "reverse of a name": ("arm.move(dx=x)", "Arm.move", "dx", "", f"arm.move(dx={P}.negative(x))"),
    "reverse within a full turn": (
        "arm.turn(90)", "Arm.turn", "angle", "",
        f"arm.turn({P}.partial({P}.negative_within, 0, 360, 360)(90))",
    ),
    "reverse of a part": (
        "arm.follow(p)", "Arm.follow", "path[1]", "", f"arm.follow({P}.changed('[1]', {P}.negative, p))"
    ),
    "by-to": (
        "arm.move(0.5)", "Arm.move", "dx", "",
        "arm.move((lambda value: value - (arm.where()) if value else value)(0.5))",
    ),
    "skip": ("arm.move(0.5)", "Arm.move", None, "", "None"),
    "skip of a call in an argument": (
        "arm.move(f())", "Arm.move", None, "", f"{P}.skipped(arm.move, lambda self: None)(f())"
    ),
    "repeat": ("arm.move(0.5)", "Arm.move", None, "", "(arm.move(0.5), arm.move(0.5))[1]"),
    "repeat of a call in an argument": ("arm.move(f())", "Arm.move", None, "", f"{P}.twice(arm.move)(f())"),
    "repeat of a call given an attribute, which may be a property": (
        "arm.move(arm.goal)", "Arm.move", None, "", f"{P}.twice(arm.move)(arm.goal)"
    ),
    "opposite": ("arm.open()", "Arm.open", None, "", "arm.close()"),
    "opposite of a value": (
        "arm.grip(closed=True)", "Arm.grip", "closed", "",
        f"arm.grip(closed={P}.partial({P}.other, {{False: True, True: False}})(True))",
    ),
    "negate": ("arm.where()", "Arm.where", "result", "", f"({P}.negative(arm.where()))"),
    "noise": (
        "arm.where()", "Arm.where", "result", "", f"{P}.changed('', {P}.partial({P}.noisy, 2.0), arm.where())"
    ),
    "misread": (
        "arm.see()", "Arm.see", ".colour", "+2",
        f"{P}.changed('.colour', {P}.partial({P}.other, "
        "{'red': 'grey', 'blue': 'red', 'grey': 'blue'}), arm.see())",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", EDITS)
def test_an_operator_is_an_edit_that_a_person_could_make(tmp_path: Path, name: str) -> None:
    call, operation, quantity, variant, expected = EDITS[name]
    source = f"x = [{call}, arm]\n"
    facts = Facts.of(project(tmp_path, source))
    operator = name.partition(" ")[0]
    found = mutant(
        call, source, operator=operator, operation=f"robot:{operation}", quantity=quantity, variant=variant
    )
    (edit,) = edits_for(facts, found)
    assert edit.applied(source.encode()).decode() == f"x = [{expected}, arm]\n"


def test_an_awaited_call_is_edited_with_its_await(tmp_path: Path) -> None:
    source = "async def f(arm): return await arm.move(1.0)\n"
    facts = Facts.of(project(tmp_path, source))
    found = mutant("arm.move(1.0)", source, operator="repeat", operation="robot:Arm.move")
    (edit,) = edits_for(facts, found)
    assert "(await arm.move(1.0), await arm.move(1.0))[1]" in edit.applied(source.encode()).decode()


@pytest.mark.parametrize(
    ("operator", "quantity", "told"),
    [("reverse", "h", "lift/-5.00"), ("opposite", None, "drop/5.00"), ("skip", None, None)],
)
@pytest.mark.parametrize("encoded", [False, True])
def test_a_text_command_is_edited_where_it_reads_like_the_pattern(
    tmp_path: Path, operator: str, quantity: str | None, told: str | None, encoded: bool
) -> None:
    texts = (b"lift/5.00", b"pick") if encoded else ("lift/5.00", "pick")
    source = f"sent = [arm.send(text) for text in {texts}]\n"
    facts = Facts.of(project(tmp_path, source))
    found = mutant(
        "arm.send(text)", source, operator=operator, operation="robot:Arm.send", quantity=quantity,
        pattern="lift/{h:g}",
    )  # fmt: skip
    (edit,) = edits_for(facts, found)
    (tmp_path / "_planted.py").write_text(Path(__file__).with_name("planted.py").read_text())
    heard: list[str] = []

    class Arm:
        def send(self, text: Any) -> None:
            assert isinstance(text, bytes) is encoded
            heard.append(text.decode() if encoded else text)

    sys.path.insert(0, str(tmp_path))
    try:
        exec(edit.applied(source.encode()).decode(), {"arm": Arm()})
    finally:
        sys.path.remove(str(tmp_path))
        sys.modules.pop("_planted", None)
    assert heard == ([told, "pick"] if told else ["pick"])


@pytest.mark.parametrize(
    ("operator", "variant", "description", "expected"),
    [
        ("AOR", "sub", "a + b → a - b", "x = (a - b)"),
        ("ABS", "failOnZero", "a + b → failOnZero(a + b)", f"x = ({P}.fail_on_zero(a + b))"),
        ("BSR", "", "x = a + b → Bomb()", f"raise {P}.PlantedError()"),
    ],
)
def test_a_mutant_of_the_text_is_what_its_description_says(
    tmp_path: Path, operator: str, variant: str, description: str, expected: str
) -> None:
    source = "x = a + b\n"
    facts = Facts.of(project(tmp_path, source))
    text = source.strip() if operator == "BSR" else "a + b"
    told = {"operator": operator, "variant": variant, "description": description, "operation": ""}
    found = mutant(text, source, family="conventional", **told)
    (edit,) = edits_for(facts, found)
    assert edit.applied(source.encode()).decode() == f"{expected}\n"


@pytest.mark.parametrize(("outer", "inner"), ["\"'", "'\""])
def test_a_mutant_inside_an_f_string_is_written_in_the_other_quotation_marks(
    tmp_path: Path, outer: str, inner: str
) -> None:
    source = f"x = f{outer}at {{y:.2f}}{outer}\n"
    found = mutant(
        "y", source, family="conventional", operator="ABS", variant="failOnZero", operation="",
        description="y → failOnZero(y)",
    )  # fmt: skip
    (edit,) = edits_for(Facts.of(project(tmp_path, source)), found)
    planted = f"(__import__({inner}_planted{inner}).fail_on_zero(y))"
    assert edit.applied(source.encode()).decode() == source.replace("y", planted)


@pytest.mark.parametrize(("outer", "inner"), ["\"'", "'\""])
def test_a_mutant_of_a_call_inside_an_f_string_is_too(tmp_path: Path, outer: str, inner: str) -> None:
    source = f"x = f{outer}at {{arm.where():.2f}}{outer}\n"
    facts = {"operator": "negate", "operation": "robot:Arm.where", "quantity": "result"}
    (edit,) = edits_for(Facts.of(project(tmp_path, source)), mutant("arm.where()", source, **facts))
    planted = f"(__import__({inner}_planted{inner}).negative(arm.where()))"
    assert edit.applied(source.encode()).decode() == source.replace("arm.where()", planted)


def test_noise_of_a_number_of_another_kind_is_of_its_kind() -> None:
    for number in (Decimal("0.75"), Fraction(3, 4)):
        drawn = noisy(0.5, number)
        assert type(drawn) is type(number)
        assert drawn != number


def test_all_tests_are_run_that_pytest_would_run(tmp_path: Path) -> None:
    folder = project(tmp_path, "def go():\n    'Goes.\\n\\n>>> go()\\n3\\n'\n    return 2\n")
    (folder / "mutabot.toml").write_text('program = ["mission.py"]')
    (folder / "pytest.ini").write_text("[pytest]\naddopts = --doctest-modules\ntestpaths = mission.py\n")
    judged = Judge(folder).original()
    assert (judged.state, judged.tests) == ("fails", ("mission.py::mission.go",))


def test_a_call_in_a_text_that_is_run_cannot_be_written(tmp_path: Path) -> None:
    source = 'exec("x = arm.where()")\n'
    facts = Facts.of(project(tmp_path, source))
    found = mutant('exec("x = arm.where()")', source, operator="negate", operation="robot:Arm.where")
    with pytest.raises(CannotWriteError, match="text that is run"):
        edits_for(facts, found)


def test_a_call_that_a_block_makes_as_it_ends_cannot_be_written(tmp_path: Path) -> None:
    source = "with ExitStack() as s: s.callback(arm.open)\n"
    facts = Facts.of(project(tmp_path, source))
    found = mutant("ExitStack()", source, operator="repeat", operation="robot:Arm.open")
    with pytest.raises(CannotWriteError, match="as it ends"):
        edits_for(facts, found)


def test_an_argument_that_is_not_given_is_its_default() -> None:
    def move(x: float, y: float = 2.0) -> tuple[float, float]:
        return x, y

    changed = with_argument(move, "y", "", lambda value: -value)
    assert (changed(1.0), changed(1.0, 3.0), changed(1.0, y=4.0)) == ((1.0, -2.0), (1.0, -3.0), (1.0, -4.0))


def test_a_label_of_an_enumeration_becomes_another_of_it() -> None:
    assert other({3: 1}, RegexFlag(3)) is RegexFlag(1)
    assert other({"red": "blue"}, "red") == "blue"


@pytest.mark.parametrize("description", ["a + c → a - c", "a + b + a very long… → a - b"])
def test_a_mutant_that_cannot_be_written_is_said_to_be_so(tmp_path: Path, description: str) -> None:
    facts = Facts.of(project(tmp_path, "x = a + b\n"))
    found = mutant(
        "a + b", "x = a + b\n", family="conventional", operator="AOR", description=description, operation=""
    )  # fmt: skip
    with pytest.raises(CannotWriteError):
        edits_for(facts, found)


def test_a_call_of_one_thing_or_another_is_edited_where_it_is_one_of_the_operation(tmp_path: Path) -> None:
    source = "x = [call() for call in (arm.where, arm.open)]\n"
    project(tmp_path, source)
    with (tmp_path / "judge.toml").open("a") as hints:
        hints.write('\n[meant]\n"mission.py:x#1" = "call == arm.where"\n')
    found = mutant("call()", source, operator="negate", operation="robot:Arm.where", quantity="result")
    (edit,) = edits_for(Facts.of(tmp_path), found)
    text = edit.applied(source.encode()).decode()
    assert f"({P}.answering(call, '', {P}.negative) if call == arm.where else call)() for call" in text


TESTS = """
    import sys

    import mission
    from robot import Arm

    def test_moves():
        arm = Arm()
        mission.run(arm)
        assert 0 <= arm.x < 3

    def test_nothing_of_mutabot_is_loaded():
        assert "mutabot" not in sys.modules
"""


def judged(folder: Path, mission: str, call: str, **facts: Any) -> Any:
    source = dedent(mission)
    found = mutant(call, source.splitlines()[1], operation="robot:Arm.move", **facts)
    found["span"] |= {"line": 2, "end_line": 2}
    return Judge(project(folder, mission, TESTS), limit=20).mutant(found, look_for_refusals=True)


MOVES = "def run(arm):\n    arm.move(2.0)\n"


def test_the_judge_says_what_plain_pytest_says(tmp_path: Path) -> None:
    survivor = judged(tmp_path, MOVES, "arm.move(2.0)", operator="skip")
    assert (survivor.state, survivor.tests) == ("passes", ())
    killed = judged(tmp_path, MOVES, "arm.move(2.0)", operator="reverse", quantity="dx")
    assert (killed.state, killed.tests, killed.refused) == ("fails", ("test_it.py::test_moves",), False)


def test_the_judge_sees_that_the_robot_refused_the_mutated_call(tmp_path: Path) -> None:
    mission = "def run(arm):\n    arm.move(-9.0)\n    arm.x = 1.0\n"
    found = judged(tmp_path, mission, "arm.move(-9.0)", operator="reverse", quantity="dx")
    assert (found.state, found.refused) == ("fails", True)


def test_the_judge_sees_a_program_that_hangs(tmp_path: Path) -> None:
    mission = "def run(arm):\n    arm.move(1.0)\n    while arm.x < 1: pass\n"
    source = dedent(mission)
    found = mutant("arm.move(1.0)", source.splitlines()[1], operation="robot:Arm.move", operator="skip")
    found["span"] |= {"line": 2, "end_line": 2}
    assert Judge(project(tmp_path, mission, TESTS), limit=3).mutant(found).state == "hangs"


@pytest.mark.parametrize(
    ("independent", "failing"), [(True, ["test_two"]), (False, ["test_one", "test_two"])]
)
def test_where_tests_are_independent_the_judge_begins_with_the_one_that_noticed_and_ends_there(
    tmp_path: Path, independent: bool, failing: list[str]
) -> None:
    tests = """
        import mission
        from robot import Arm

        def test_one():
            arm = Arm()
            mission.run(arm)
            assert arm.x == 2.0

        def test_two():
            test_one()
    """
    project(tmp_path, MOVES, tests)
    hints = tmp_path / "judge.toml"
    hints.write_text(f"independent = {str(independent).lower()}\n{hints.read_text()}")
    call = "arm.move(2.0)"
    found = mutant(call, MOVES.splitlines()[1], operation="robot:Arm.move", operator="skip")
    found["span"] |= {"line": 2, "end_line": 2}
    judgement = Judge(tmp_path, limit=20).mutant(found, first="test_it.py::test_two")
    assert judgement.tests == tuple(f"test_it.py::{name}" for name in failing)


def test_the_judge_imports_nothing_of_mutabot() -> None:
    code = (
        "import json, sys, suites.judge, suites.planted;"
        "print(json.dumps([name for name in sys.modules if name.startswith('mutabot')]))"
    )
    folder = Path(__file__).resolve().parents[1]
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=True
    )
    assert json.loads(done.stdout) == []


CATALOGUE = '__import__("_planted_catalogue")'
FAULTS = {
    "cm-for-m": (
        "arm.move(0.5)", "Arm.move", "dx", "taken-cm",
        f"arm.move({P}.partial({CATALOGUE}.scaled, 0.01)(0.5))",
    ),
    "old-reading": (
        "arm.where()", "Arm.where", "result", "1",
        f"{P}.changed('', {P}.partial({CATALOGUE}.old, 'mission.py:x#1:call:y', 1), arm.where())",
    ),
    "stuck-flag": (
        "arm.where()", "Arm.where", "result", "true", f"{P}.changed('', (lambda value: True), arm.where())"
    ),
    "double-command": (
        "arm.open()", "Arm.open", None, "30%", f"{CATALOGUE}.by_chance(0.3, arm.open, {P}.twice(arm.open))()"
    ),
    "swap-next": (
        "arm.open(), arm.move(1.0)", "Arm.move", None, "",
        f"{CATALOGUE}.then(arm.open)(), {CATALOGUE}.held(arm.move, lambda self: None)(1.0)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("operator", FAULTS)
def test_a_fault_of_the_catalogue_is_an_edit_too(tmp_path: Path, operator: str) -> None:
    call, operation, quantity, variant, expected = FAULTS[operator]
    source = f"x = [{call}, arm]\n"
    facts = Facts.of(project(tmp_path, source))
    told = {"operator": operator, "operation": f"robot:{operation}", "quantity": quantity, "variant": variant}
    found = source.encode()
    for edit in sorted(
        edits_of(facts, mutant(call, source, family="catalogue", **told)), key=lambda edit: -edit.start
    ):
        found = edit.applied(found)
    assert found.decode() == f"x = [{expected}, arm]\n"


def test_the_judge_knows_every_operator_of_the_catalogue() -> None:
    units = {"cm-for-m", "mm-for-m", "inch-for-mm", "deg-for-rad", "ms-for-s"}
    found = {name for name in names() if operator_of(name).family == "catalogue"}
    assert units < found
    edits = {name: "_" + name.replace("-", "_") for name in found - units}
    assert [name for name, edit in edits.items() if not hasattr(CatalogueEditor, edit)] == []


REFUSED = """
_________________________ test_a _________________________
mission.py:{}: in run
E   robot.Refused: out of reach
_________________________ test_b _________________________
mission.py:1: in run
E   robot.Refused: out of reach
"""


@pytest.mark.parametrize(("line", "is_refused"), [(1, True), (2, False)])
def test_a_mutant_is_refused_if_its_own_call_is_wherever_a_test_fails(
    tmp_path: Path, line: int, is_refused: bool
) -> None:
    source = "arm.move(0.5)\n"
    judge = Judge(project(tmp_path, source))
    found = mutant("arm.move(0.5)", source, operator="reverse", operation="robot:Arm.move", file="mission.py")
    judge_says = judge._names_a_refusal(REFUSED.format(line), found)
    assert judge_says is is_refused


@pytest.mark.parametrize("is_robots_own", [False, True])
def test_a_command_made_of_a_mutated_reading_in_its_line_is_no_refusal_of_the_reading(
    tmp_path: Path, is_robots_own: bool
) -> None:
    source = "def back(arm): arm.move(-arm.where())\n"
    tests = """
        import mission, robot

        def test_back():
            arm = robot.Arm()
            arm.x = 6
            mission.back(arm)
    """
    folder = project(tmp_path, source, tests)
    if not is_robots_own:  # as if another package defined it
        file = folder / "robot.toml"
        file.write_text(file.read_text().replace("robot:Refused", "another:Refused"))
    found = mutant("arm.where()", source, operator="negate", operation="robot:Arm.where", quantity="result")
    found["description"] = "arm.where: reads result (x) -6 m instead of 6 m"
    judged = Judge(folder).mutant(found, look_for_refusals=True)
    assert (judged.state, judged.refused) == ("fails", False)
