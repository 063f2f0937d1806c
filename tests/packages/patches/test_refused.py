"""A test that the robot's refusal ends has not judged a patch, unless the original is refused as well."""

from __future__ import annotations

import difflib
import json
from pathlib import Path
from textwrap import dedent

import pytest

from tests.campaign.project import ROBOT, VOCABULARY
from tests.plugins.test_faults import write
from tests.plugins.test_plugins import mutabot

PROGRAM = """
    from contextlib import suppress

    from robot import Refused

    def near(arm):
        arm.move_by(0.5)

    def too_far(arm, tries):
        with suppress(Refused if tries < 3 else OSError):
            arm.move_by(5.0)
"""
PROJECT = {
    "mutabot.toml": 'program = ["mission.py"]\nfamilies = ["patch"]\nvocabulary = ["robot.toml"]\n',
    "robot.toml": VOCABULARY,
    "robot.py": ROBOT,
    "mission.py": PROGRAM,
    "tests/test_mission.py": """
        import mission
        from robot import Arm

        def test_near():
            mission.near(Arm())

        def test_too_far():
            mission.too_far(Arm(), 2)
        """,
}
#: the text that each patch changes, and the verdict
EDITS = {
    "farther": ("move_by(0.5)", "move_by(0.5 + 1)", "refused"),
    "below new lines": ("arm.move_by(0.5)", "x = 0.5\n    y = x + 1\n    arm.move_by(y)", "refused"),
    "of the original": ("tries < 3", "tries > 3", "killed"),
    "moved": (
        "with suppress(Refused if tries < 3",
        "x = 3\n    with suppress(Refused if tries > x",
        "killed",
    ),
}


@pytest.mark.parametrize("engine", ["auto", pytest.param("replay", marks=pytest.mark.whole)])
def test_refusals_of_patched_programs(tmp_path: Path, engine: str) -> None:
    project = write(tmp_path, PROJECT)
    before = dedent(PROGRAM).lstrip("\n")
    assert (project / "mission.py").read_text() == before
    (project / "patches").mkdir()
    for name, (old, new, _) in EDITS.items():
        lines = (text.splitlines(keepends=True) for text in (before, before.replace(old, new)))
        patch = "".join(difflib.unified_diff(*lines, "a/mission.py", "b/mission.py"))
        (project / f"patches/{name}.patch").write_text(patch)
    told = json.loads(mutabot(None, project, "run", "--json", "--engine", engine).stdout)
    found = {
        mutant["description"].partition("/")[2].partition(".patch")[0]: mutant["rounds"][0]["verdict"]
        for mutant in told["mutants"]
    }
    assert found == {name: verdict for name, (_, _, verdict) in EDITS.items()}
