"""Up to which disturbance do programs of other people's simulators do their task, by the shipped parameters?

Each task is a scripted policy, started from some seeds, a test each. ``mutabot run --family world`` disturbs
the simulators through ``mutabot_world:mujoco.toml`` and ``mutabot_world:pybullet.toml``; nothing in the
programs knows of that. A test that passes is a success.

Use, with a Python that has mutabot and the packages: ``python benchmarks/foreign_worlds.py [TASK …]
[--seeds N]``, after ``pip install metaworld gymnasium-robotics panda-gym``. Prints a table in Markdown.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

METAWORLD = """
import random

import metaworld
import numpy as np
from metaworld.policies import {policy} as Policy


def episode(seed):
    random.seed(seed)
    np.random.seed(seed)
    made = metaworld.MT1("{task}", seed=seed)
    env = made.train_classes["{task}"]()
    env.set_task(made.train_tasks[seed])
    policy = Policy()
    seen, _ = env.reset(seed=seed)
    for _ in range(400):
        seen, _, _, _, info = env.step(np.clip(policy.get_action(seen), -1, 1))
        if info["success"] > 0.5:
            return True
    return False
"""
GOALS = """
import gymnasium
import {package}
import numpy as np

gymnasium.register_envs({package})


def episode(seed):
    env = gymnasium.make("{task}", max_episode_steps=100)
    seen, _ = env.reset(seed=seed)
    held = 0
    for _ in range(100):
        tool, part = seen["observation"][:3], seen["observation"][{part}]
        grip = -1.0
        if held == 0:
            above = np.linalg.norm((tool - part)[:2]) > 0.01
            way, grip = part + [0, 0, 0.06 if above else 0.0] - tool, 1.0
            held = int(np.linalg.norm(tool - part) < 0.01)
        elif held < 8:
            way, held = np.zeros(3), held + 1
        else:
            way = seen["desired_goal"] - part
        action = np.append(np.clip(10 * way, -1, 1), grip)
        seen, _, _, _, info = env.step(action.astype(np.float32))
    env.close()
    return bool(info["is_success"])
"""
TEST = """
import pytest
import policy


@pytest.mark.parametrize("seed", range({seeds}))
def test_the_task_is_done(seed):
    assert policy.episode(seed)
"""
CONFIGURATION = """
[tool.pytest.ini_options]
pythonpath = ["."]

[tool.mutabot]
program = ["policy.py"]
families = ["world"]
rounds = 1
evidence = 0

[tool.mutabot.world]
parameters = ["mutabot_world:{vocabulary}.toml"]
only = {only}
names = {{ {names} }}
"""


@dataclass(frozen=True)
class Task:
    """A task of a simulator.

    Attributes:
        policy: text of the program.
        vocabulary: name of the file of parameters.
        names: parameters to the things that are meant.
    """

    policy: str
    vocabulary: str
    names: Mapping[str, str]


_SAWYER = {"mass": "obj", "friction": "*", "gain": "*"}
TASKS = {
    "metaworld pick-place": Task(
        METAWORLD.format(task="pick-place-v3", policy="SawyerPickPlaceV3Policy"), "mujoco", _SAWYER
    ),
    "metaworld push": Task(METAWORLD.format(task="push-v3", policy="SawyerPushV3Policy"), "mujoco", _SAWYER),
    "gymnasium-robotics FetchPickAndPlace": Task(
        GOALS.format(package="gymnasium_robotics", task="FetchPickAndPlace-v4", part="3:6"),
        "mujoco",
        {"mass": "object0", "friction": "*", "gain": "*"},
    ),
    "panda-gym PandaPickAndPlace": Task(
        GOALS.format(package="panda_gym", task="PandaPickAndPlace-v3", part="7:10"),
        "pybullet",
        {"mass": "body 3", "friction": "*", "gain": "*", "strength": "*finger*"},
    ),
}


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("tasks", nargs="*", help=", ".join(TASKS))
    parser.add_argument("--seeds", type=int, default=5)
    given = parser.parse_args()
    if unknown := {*given.tasks} - {*TASKS}:
        parser.error(f"no task {', '.join(unknown)}; there are: {', '.join(TASKS)}")
    print(f"| task | parameter | magnitude: on how many of {given.seeds} seeds the task is done |")
    print("|---|---|---|")
    for name in given.tasks or TASKS:
        with tempfile.TemporaryDirectory() as folder:
            for line in rows(name, Path(folder), given.seeds):
                print(line, flush=True)
    return 0


def rows(name: str, folder: Path, seeds: int) -> Iterator[str]:
    """Run the campaign of a task; yield a row for each parameter."""
    task = TASKS[name]
    (folder / "tests").mkdir()
    (folder / "policy.py").write_text(task.policy, encoding="utf-8")
    (folder / "tests" / "test_task.py").write_text(TEST.format(seeds=seeds), encoding="utf-8")
    names = ", ".join(f'{key} = "{pattern}"' for key, pattern in task.names.items())
    text = CONFIGURATION.format(vocabulary=task.vocabulary, only=[*task.names], names=names)
    (folder / "pyproject.toml").write_text(text, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "mutabot", "run", "--json", "--fresh"],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode:
        raise SystemExit(f"{name}: {done.stderr[-2000:]}")
    found: dict[str, dict[float, list[str]]] = {}
    for mutant in json.loads(done.stdout)["graded"]:
        sizes = found.setdefault(f"{mutant['call']} {mutant['direction']}", {})
        sizes.setdefault(mutant["magnitude"], []).append(mutant["rounds"][0]["verdict"])
    for parameter, sizes in found.items():
        cells = (
            f"{size:g} %: {ends.count('survived')}{others(ends)}" for size, ends in sorted(sizes.items())
        )
        yield f"| {name} | {parameter} | {', '.join(cells)} |"


def others(ends: Sequence[str]) -> str:
    """What else than a test that passes or fails came out."""
    found = sorted({*ends} - {"survived", "killed"})
    return f" ({', '.join(f'{ends.count(found_end)} {found_end}' for found_end in found)})" if found else ""


if __name__ == "__main__":
    sys.exit(main())
