"""What decides a test may come from a test before it, from a new file, or from text that is read as data."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from mutabot.campaign.run import run_campaign
from tests.campaign.project import Quiet, request_for, write_project

MISSION = "def left(arm):\n    arm.move_by(0.2)\n"
HEAD = "import multiprocessing\nfrom functools import cache\nimport mission, state\nfrom robot import Arm\n"
JUDGES = """
def test_b():
    arm = Arm()
    mission.left(arm)
    assert abs(arm.x - 0.2) < {limit}
"""
STATE = "TOL = [1]\n\ndef tighten(limits, tol=0.01):\n    limits[0] = tol\n\ndef tol():\n    return 0.01\n"
#: kind -> the test before the judge, the limit it judges by, and the edit: a file with its old and new text
KINDS = {
    "a test writes to a list of a module": (
        "def test_a():\n    state.TOL[0] = 0.01\n",
        "state.TOL[0]", ("tests/test_mission.py", "= 0.01", "= 50"),
    ),
    "a function that a test calls writes to it": (
        "def test_a():\n    state.tighten(state.TOL)\n", "state.TOL[0]", ("state.py", "tol=0.01", "tol=50"),
    ),
    "a function that is called writes to what is cached": (
        "@cache\ndef shared():\n    return [1]\ndef test_0():\n    shared()\n"
        "def test_a():\n    state.tighten(shared(), state.tol())\n",
        "shared()[0]", ("state.py", "return 0.01", "return 50"),
    ),
    "a process that is spawned computes it": (
        "def limit():\n    with multiprocessing.get_context('spawn').Pool(1) as pool:\n"
        "        return pool.apply(state.tol)\n",
        "limit()", ("state.py", "return 0.01", "return 50"),
    ),
}  # fmt: skip


def again(folder: Path) -> str:
    """Run a campaign; what it says of outcomes that still hold."""
    progress = Quiet()
    run_campaign(request_for(folder), progress)
    return next((line for line in progress.lines if line.startswith("reused")), "")


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[] if n == 0 else pytest.mark.whole) for n, kind in enumerate(KINDS)]
)
def test_what_was_left_behind_counts(tmp_path: Path, kind: str) -> None:
    before, limit, (file, old, new) = KINDS[kind]
    tests = HEAD + before + JUDGES.format(limit=limit)
    folder = write_project(tmp_path, MISSION, tests, more={"state.py": STATE})
    again(folder)
    assert not again(folder).startswith("reused 0 of")
    edited = folder / file
    assert old in edited.read_text()
    edited.write_text(edited.read_text().replace(old, new, 1))
    assert again(folder).startswith("reused 0 of")


@pytest.mark.whole
@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("tests/test_a.py", "import tune\n\ndef test_a():\n    pass\n"),
        ("tests/test_a.py", "import state\nstate.TOL = [50]\n\ndef test_a():\n    pass\n"),
        ("tests/test_a.py", "import state\n\ndef test_a():\n    state.tighten(state.TOL, 50)\n"),
    ],
)
def test_a_new_file_before_counts(tmp_path: Path, file: str, text: str) -> None:
    more = {"state.py": STATE.replace("[1]", "[0.01]"), "tune.py": "import state\nstate.TOL = [50]\n"}
    folder = write_project(tmp_path, MISSION, HEAD + JUDGES.format(limit="state.TOL[0]"), more=more)
    again(folder)
    (folder / file).write_text(dedent(text))
    assert again(folder).startswith("reused 0 of")


@pytest.mark.whole
def test_text_that_is_read_while_the_program_is_imported_counts(tmp_path: Path) -> None:
    mission = "from pathlib import Path\nexec(Path(__file__).with_name('limits.py').read_text())\n" + MISSION
    tests = HEAD + JUDGES.format(limit="mission.LIMIT")
    folder = write_project(tmp_path, mission, tests, more={"state.py": STATE, "limits.py": "LIMIT = 0.01\n"})
    again(folder)
    (folder / "limits.py").write_text("LIMIT = 50\n")
    assert again(folder).startswith("reused 0 of")
