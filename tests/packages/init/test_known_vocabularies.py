"""``mutabot init`` on programs whose robot API has a vocabulary that comes with mutabot.

Modules of the same names stand in for the packages; ``make shipped`` looks at the packages themselves.
"""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

import pytest

from mutabot.campaign.checking import check
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot_init.propose import propose
from tests.campaign.project import Quiet, request_for

BULLET = """
    POSITION_CONTROL = 2
    STATE = {"angle": 0.0, "steps": 0}

    def setJointMotorControl2(body, joint, mode, targetPosition=None, **rest):
        STATE["angle"] = targetPosition

    def stepSimulation():
        STATE["steps"] += 1

    def getJointState(body, joint):
        return STATE["angle"], 0.0, (0, 0, 0), 0.0

    def loadURDF(name): return 1
    def setGravity(x, y, z): ...
"""
BULLET_PROGRAM = """
    import pybullet as p

    def turn(body):
        p.setJointMotorControl2(body, 0, p.POSITION_CONTROL, targetPosition=0.5)
        for _ in range(10):
            p.stepSimulation()
        return p.getJointState(body, 0)[0]
"""
GYMNASIUM = """
    class Env:
        def step(self, action): raise NotImplementedError

    class Wrapper(Env):
        def __init__(self, env): self.env = env
        def step(self, action): return self.env.step(action)
"""
METAWORLD = """
    from gymnasium.core import Env

    class SawyerXYZEnv(Env):
        hand = 0.0
        def step(self, action):
            self.hand += action[0]
            return [self.hand, 0, 0, 1, 0, 0, 0], 0.0, False, False, {"success": float(self.hand > 1)}
"""
STEPS = """
    def go(env):
        for _ in range(3):
            result = env.step([0.5, 0.25, 0.125, 1.0])
        return result[4]["success"]
"""


def write(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True, parents=True)
        path.write_text(textwrap.dedent(text))
    return folder


@pytest.fixture
def bullet(tmp_path: Path) -> Path:
    test = "import program\ndef test_it(): assert program.turn(1) == 0.5\n"
    return write(tmp_path, {"pybullet.py": BULLET, "program.py": BULLET_PROGRAM, "test_program.py": test})


def test_a_vocabulary_that_says_everything_is_all_there_is(bullet: Path) -> None:
    told = "\n".join(propose(bullet, [Path("program.py")]))
    assert load_configuration(bullet).vocabulary == ("pybullet",)
    assert "vocabulary pybullet: comes with mutabot" in told
    assert not (bullet / "robot.toml").exists()  # the clock says what stepSimulation is


def test_what_it_does_not_say_stands_beside_it(bullet: Path) -> None:
    write(bullet, {"program.py": BULLET_PROGRAM.replace("for _", "p.setGravity(0, 0, -9.81)\n        for _")})
    propose(bullet, [Path("program.py")])
    assert load_configuration(bullet).vocabulary == ("pybullet", "robot.toml")
    text = (bullet / "robot.toml").read_text()
    assert 'call = "pybullet:setGravity"' in text
    assert "stepSimulation" not in text


def test_check_reports_in_one_line_what_of_it_no_test_reaches(bullet: Path) -> None:
    propose(bullet, [Path("program.py")])
    described = {
        operation.target.partition(":")[2] for operation in load_vocabulary(("pybullet",), bullet).operations
    }
    missing = described - {"setJointMotorControl2", "stepSimulation", "getJointState"}
    with (bullet / "pybullet.py").open("a") as file:
        file.writelines(f"def {name}(*args): ...\n" for name in sorted(missing))
    report = check(request_for(bullet), Quiet())
    (unused,) = [line for line in report.lines if line.startswith("unused")]
    assert re.match(
        r"unused +\d+ of \d+ operations of pybullet, which no test reaches from the program or the oracle: ",
        unused,
    )
    assert f"{len(report.data['unused'])} of {len(described)} operations" in unused


@pytest.mark.parametrize(("behind", "expected"), [("metaworld", "metaworld"), ("other", "gymnasium")])
def test_an_environment_behind_wrappers_has_its_own_vocabulary(
    tmp_path: Path, behind: str, expected: str
) -> None:
    test = f"""
        from gymnasium.core import Wrapper
        from {behind}.sawyer_xyz_env import SawyerXYZEnv
        import steps

        def test_it():
            assert steps.go(Wrapper(SawyerXYZEnv()))
    """
    files = {
        "lib/gymnasium/core.py": GYMNASIUM,
        f"lib/{behind}/sawyer_xyz_env.py": METAWORLD,
        "lib/gymnasium/__init__.py": "",
        f"lib/{behind}/__init__.py": "",
        "steps.py": STEPS,
        "tests/test_steps.py": test,
        "pytest.ini": "[pytest]\npythonpath = lib .\n",
    }
    propose(write(tmp_path, files), [Path("steps.py")])
    assert load_configuration(tmp_path).vocabulary == (expected,)


def test_without_a_run_the_imports_of_the_program_count(bullet: Path) -> None:
    write(bullet, {"test_program.py": "import simulator_that_is_missing\n"})
    told = "\n".join(propose(bullet, [Path("program.py")]))
    assert "simulator_that_is_missing" in told
    assert load_configuration(bullet).vocabulary == ("pybullet",)
