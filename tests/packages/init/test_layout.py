"""Which files `mutabot init` takes for the robot program, in layouts that projects have."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest

from mutabot_init.layout import look
from mutabot_init.propose import propose

ARM = """
    class Arm:
        x = 0.0
        def move_to(self, x): self.x = x
        def position(self): return self.x
"""
PROGRAM = "from {arm} import Arm\ndef transfer(arm): arm.move_to(0.4)\n"
TEST = """
    from {arm} import Arm
    from {program} import transfer
    def test_transfer():
        arm = Arm()
        transfer(arm)
        assert arm.position() == 0.4
"""
SETUP = "from setuptools import setup\nsetup()\n"
TASKS = "from invoke import task\n"


def write(root: Path, files: dict[str, str], **names: str) -> Path:
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(dedent(text).format(**names))
    return root


LAYOUTS = {
    "src, and examples that use the package": (
        {
            "setup.py": SETUP,
            "src/kit/__init__.py": "from .transfer import transfer\n",
            "src/kit/arm.py": ARM,
            "src/kit/transfer.py": PROGRAM.replace("{arm}", ".arm"),
            "examples/demo.py": "from kit.transfer import transfer\n",
            "docs/conf.py": "import kit\n",
            "tests/test_transfer.py": TEST,
        },
        ("kit.arm", "kit.transfer"),
        "src/kit/transfer.py",
    ),
    "flat, with a script that no test reaches": (
        {
            "arm.py": ARM,
            "station.py": PROGRAM,
            "plot_results.py": "import arm\n",
            "setup.py": SETUP,
            "test_station.py": TEST,
        },
        ("arm", "station"),
        "station.py",
    ),
    "package and scripts": (
        {
            "feeder/__init__.py": "",
            "feeder/arm.py": ARM,
            "feeder/cell.py": PROGRAM,
            "scripts/run_main.py": "from feeder.cell import transfer\n",
            "scripts/calibrate_main.py": "from feeder.arm import Arm\n",
            "tests/helpers.py": "from feeder.arm import Arm\nfrom feeder.cell import transfer\n",
            "tests/test_cell.py": "from helpers import transfer\n",
        },
        ("feeder.arm", "feeder.cell"),
        "feeder/cell.py",
    ),
    "tests beside the program": (
        {
            "line/__init__.py": "",
            "line/arm.py": ARM,
            "line/unload.py": PROGRAM,
            "line/test_unload.py": TEST,
            "line/app_config.py": "import os\n",
            "tasks.py": TASKS,
        },
        ("line.arm", "line.unload"),
        "line/unload.py",
    ),
    "a program among examples, beside notebooks and benchmarks": (
        {
            "armlib/__init__.py": "from .arm import Arm\n",
            "armlib/arm.py": ARM,
            "notebooks/analysis_main.py": "import armlib\n",
            "benchmarks/bench_main.py": "import armlib\n",
            "examples/transfer.py": PROGRAM,
            "tests/test_transfer.py": TEST,
        },
        ("armlib", "examples.transfer"),
        "examples/transfer.py",
    ),
    "a program that its test runs as a script": (
        {
            "arm.py": ARM,
            "palletizer.py": PROGRAM,
            "process_logs.py": "import arm\n",
            "tests/test_run.py": "import runpy\ndef test_it(): runpy.run_path('./palletizer.py')\n",
        },
        ("arm", "palletizer"),
        "palletizer.py",
    ),
    "a program that imports nothing, beside a driver that does": (
        {
            "arm.py": "import asyncio\nimport os.path\n"
            + dedent(ARM)
            + """
    def settle(self):
        self.log = {{}}
        self.log.update(x=os.path.join("a", "b"))
        asyncio.run(asyncio.sleep(0))
""",
            "transfer.py": "def transfer(arm): arm.move_to(0.4)\n",
            "test_transfer.py": TEST,
        },
        ("arm", "transfer"),
        "transfer.py",
    ),
    "tools that import the program": (
        {
            "setup.py": SETUP,
            "tasks.py": TASKS,
            "ci/process_release.py": "import weld\n",
            "weld/__init__.py": "",
            "weld/__main__.py": "from weld.seam import transfer\n",
            "weld/arm.py": ARM,
            "weld/seam.py": PROGRAM,
            "unit_tests/test_seam.py": TEST,
        },
        ("weld.arm", "weld.seam"),
        "weld/seam.py",
    ),
}


@pytest.mark.parametrize("name", LAYOUTS)
def test_the_program_is_what_the_tests_reach_and_nothing_else_imports(tmp_path: Path, name: str) -> None:
    files, (arm, program), expected = LAYOUTS[name]
    layout = look(write(tmp_path, files, arm=arm, program=program), [])
    assert [layout.relative(path) for path in layout.program] == [expected]


def test_without_tests_that_import_it_a_telling_name_decides(tmp_path: Path) -> None:
    files = {"arm.py": ARM, "mission.py": PROGRAM, "replace_tool.py": "import arm\n", "test_it.py": ""}
    layout = look(write(tmp_path, files, arm="arm"), [])
    assert [path.name for path in layout.program] == ["mission.py"]  # "replace" is no "place"


def test_a_guess_of_which_the_tests_run_no_call_is_reported(tmp_path: Path) -> None:
    test = """
        from arm import Arm
        from units import METRE
        def test_it():
            arm = Arm()
            arm.move_to(METRE)
            assert arm.height_mm() == METRE
    """
    arm = ARM.replace("position(", "height_mm(")
    files = {"arm.py": arm, "units.py": "import math\nMETRE = math.cos(0)\n", "test_arm.py": test}
    *_, last = propose(write(tmp_path, {**files, "task_units.py": "import arm, units\n"}, arm="arm"))
    assert last.startswith("next: no test runs a call of the guessed program")
    assert "remove mutabot.toml and robot.toml, and run `mutabot init FILE…`" in last
