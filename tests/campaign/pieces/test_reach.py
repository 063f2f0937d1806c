"""What a test can reach, and what a piece of program text says."""

from __future__ import annotations

import hashlib
from textwrap import dedent

import pytest

from mutabot.campaign.pieces.project import Lines, Project
from mutabot.campaign.pieces.reach import Reach

FILES = {
    "robot.py": """
        class Arm:
            def move(self, dx):
                self.x = self.limited(dx)

            def limited(self, dx):
                return dx

            def park(self):
                self.x = 0

            def __enter__(self):
                return self
        """,
    "mission.py": """
        from robot import Arm

        SPEED = 3
        NEVER = 4

        def left(arm):
            arm.move(SPEED)

        def right(arm):
            arm.move(1)
            arm.park()
        """,
    "test_it.py": """
        import pytest
        from mission import left, right as to_the_right

        @pytest.fixture
        def arm():
            return make()

        @pytest.fixture(autouse=True)
        def clean():
            tidy()

        def make():
            from robot import Arm
            return Arm()

        def tidy():
            pass

        def test_left(arm):
            left(arm)

        def test_right(arm):
            to_the_right(arm)
        """,
}


def project_of(files: dict[str, str]) -> Project:
    texts = {name: dedent(text).encode() for name, text in files.items()}
    digests = {name: hashlib.sha256(text).hexdigest() for name, text in texts.items()}
    return Project(digests, texts, [name for name in files if name.startswith("test")])


def reached(files: dict[str, str], test: str) -> set[str]:
    reach = Reach(project_of(files), ())
    found = reach.of_tests([f"test_it.py::{test}"], lambda name: name.partition("::")[0])
    return set(reach.says(found))


def digest(files: dict[str, str], test: str = "test_left") -> str:
    reach = Reach(project_of(files), ())
    return reach.digest(reach.of_tests([f"test_it.py::{test}"], lambda name: name.partition("::")[0]))


def edited(name: str, old: str, new: str) -> dict[str, str]:
    assert old in FILES[name]
    return {**FILES, name: FILES[name].replace(old, new)}


def test_a_test_reaches_what_it_mentions_and_what_that_mentions() -> None:
    found = reached(FILES, "test_left")
    assert {
        "test_left() in test_it.py", "arm() in test_it.py", "make() in test_it.py", "left() in mission.py",
        "SPEED in mission.py", "Arm in robot.py", "Arm.move() in robot.py", "Arm.limited() in robot.py",
        "Arm.__enter__() in robot.py", "clean() in test_it.py", "tidy() in test_it.py",
    } <= found  # fmt: skip
    for other in ("right() in mission.py", "NEVER in mission.py", "test_right() in test_it.py"):
        assert other not in found
    assert "Arm.park() in robot.py" not in found


def test_a_name_that_an_import_gives_leads_to_what_has_another() -> None:
    assert {"right() in mission.py", "Arm.park() in robot.py"} <= reached(FILES, "test_right")


@pytest.mark.parametrize(
    "line",
    [
        "getattr(arm, 'mo' + 've')(1)",
        "eval('1')",
        "globals()['left'](arm)",
        "__import__('mission')",
        "vars(arm)",
    ],
)
def test_where_names_are_computed_everything_is_reached(line: str) -> None:
    files = edited("test_it.py", "left(arm)\n", f"{line}\n")
    assert "right() in mission.py" in reached(files, "test_left")


@pytest.mark.parametrize("line", ["getattr(arm, 'park')()", "patch('mission.right')", "use('right')"])
def test_text_that_consists_of_names_mentions_them(line: str) -> None:
    found = reached(edited("test_it.py", "left(arm)\n", f"{line}\n"), "test_left")
    assert found & {"Arm.park() in robot.py", "right() in mission.py"}


def test_a_class_of_others_may_call_every_method() -> None:
    files = edited("robot.py", "class Arm:", "class Arm(Node):")
    assert "Arm.park() in robot.py" in reached(files, "test_left")
    files = edited("robot.py", "class Arm:", "class Node:\n            pass\n\n        class Arm(Node):")
    assert "Arm.park() in robot.py" not in reached(files, "test_left")


def test_what_runs_at_import_is_reached_by_every_test() -> None:
    files = {**FILES, "spare.py": "import mission\nmission.right(None)\n"}
    assert "right() in mission.py" in reached(files, "test_left")
    files = {**FILES, "spare.py": "import mission\n@mission.register\ndef one():\n    mission.right(None)\n"}
    assert {"one() in spare.py", "right() in mission.py"} <= reached(files, "test_left")


def test_the_main_block_counts_where_processes_begin() -> None:
    main = "if __name__ == '__main__':\n    from mission import right\n    right(None)\n"
    files = {**FILES, "spare.py": main}
    assert "right() in mission.py" not in reached(files, "test_left")
    files = edited("test_it.py", "tidy()\n", "subprocess.run(['spare'])\n") | {"spare.py": main}
    assert "right() in mission.py" in reached(files, "test_left")


def test_layout_and_comments_say_nothing_and_everything_else_does() -> None:
    before = digest(FILES)
    for name, text in FILES.items():
        assert digest({**FILES, name: "# a comment\n\n" + dedent(text)}) == before
    laid_out = edited("mission.py", "arm.move(SPEED)", "arm.move(\n                SPEED,\n            )")
    assert digest(laid_out) == before
    assert digest(edited("mission.py", "SPEED = 3", "SPEED = 2")) != before
    assert digest(edited("mission.py", "NEVER = 4", "NEVER = 5")) == before
    assert digest(edited("robot.py", "return dx", "return -dx")) != before
    assert digest(edited("robot.py", "self.x = 0", "self.x = 1")) == before
    assert digest(edited("mission.py", "arm.move(1)", "arm.move(2)")) == before


def test_a_method_that_nobody_mentions_goes_with_its_class() -> None:
    assert "Arm.park() in robot.py" in reached(edited("mission.py", "arm.park()", "pass"), "test_left")


def test_the_origin_of_a_name_counts() -> None:
    more = {"other.py": "def left(arm):\n    pass\n"}
    before = digest({**FILES, **more})
    files = edited(
        "test_it.py", "from mission import left, right", "from other import left\nfrom mission import right"
    )
    assert digest({**files, **more}) != before


def test_lines_go_where_the_same_text_goes() -> None:
    old = project_of(FILES)
    new = project_of(edited("mission.py", "SPEED = 3", "SPEED = 3\n        # more\n        # more"))
    lines = Lines(old, new)
    assert lines.moved("mission.py:8: x, mission.py:8:4-8:19 y, other.py:7") == (
        "mission.py:10: x, mission.py:10:4-10:19 y, other.py:7"
    )
    assert lines.moved("mission.py:99") is None
    changed = project_of(edited("mission.py", "arm.move(SPEED)", "arm.move(SPEED + 1)"))
    assert Lines(old, changed).moved("mission.py:8") is None
    farther = {name.replace("mission", "errand"): text for name, text in FILES.items()}
    assert Lines(old, project_of(farther)).moved("mission.py:8") is None


def test_which_names_a_star_imports_concerns_everybody() -> None:
    star = edited("test_it.py", "import pytest\n", "import pytest\n        from mission import *\n")
    names = {**star, "mission.py": "__all__ = ['left']\n" + dedent(star["mission.py"])}
    fewer = {**star, "mission.py": "__all__ = []\n" + dedent(star["mission.py"])}
    assert project_of(names).around != project_of(fewer).around
    assert project_of(star).around != project_of(fewer).around


def test_names_that_no_star_imports_concern_nobody() -> None:
    names = {**FILES, "mission.py": "__all__ = ['left']\n" + dedent(FILES["mission.py"])}
    assert project_of(names).around == project_of(FILES).around
