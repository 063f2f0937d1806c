import ast
import inspect
from pathlib import Path

import mission
import taken_over
from robot import Arm


def test_text_is_run():
    names = {}
    exec(Path("mission.py").read_text(), names)
    arm = Arm()
    assert names["main"](arm) == 0.25
    assert arm.done[1] == ("turn", 30)


def test_compiled_text_is_run():
    names = {"__name__": "mission"}
    exec(compile(Path("mission.py").read_bytes(), "<mission>", "exec"), names)
    arm = Arm()
    names["main"](arm)
    assert len(arm.done) == 3


def test_a_tree_is_run():
    names = {"__name__": "mission"}
    exec(compile(ast.parse(Path("mission.py").read_text()), "<tree>", "exec"), names)
    arm = Arm()
    names["main"](arm)
    assert arm.turned == 30


def test_the_program_is_run():
    assert mission.main(Arm()) > 0


def test_a_program_with_the_same_text_is_another_one():
    """An edit of the program does not reach it."""
    arm = Arm()
    taken_over.main(arm)
    assert arm.done == [("lift", 0.5), ("turn", 30), ("lift", -0.25)]


def test_one_function_is_run():
    names = {}
    exec(inspect.getsource(mission.main), names)
    arm = Arm()
    names["main"](arm)
    assert arm.done == [("lift", 0.5), ("turn", 30), ("lift", -0.25)]


def test_a_changed_copy_is_run(tmp_path):
    path = tmp_path / "slow.py"
    path.write_text("import time\n\n" + Path("mission.py").read_text() + "    time.sleep(5)\n")
    names = {}
    exec(compile(path.read_text(), str(path), "exec"), names)
    arm = Arm()
    assert names["main"](arm) == 0.25
