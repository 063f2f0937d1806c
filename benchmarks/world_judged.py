"""Do the engines find of a disturbed world what plain pytest finds, with the set-up edited by hand?

Each disturbance of a few short tests of the examples runs by both engines. For each, the text of a copy's
``conftest.py`` gets lines that change the cell as somebody would who knows nothing of Mutabot: by MuJoCo's
own fields and the cell's own attributes. Plain pytest runs the test on that copy, without Mutabot's plug-in,
with the seed of the round.

Use: ``python benchmarks/world_judged.py [EXAMPLE …] [--engines fork replay] [--only PARAMETER …]``. The exit
code is 1 if one verdict differs, or if there is nothing to compare.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import dedent, indent
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from suites.agreement import ENGINES, campaign, request_for, seeds_of  # noqa: E402
from suites.corpus import copied  # noqa: E402
from suites.editor import Facts  # noqa: E402

_SETTLE = "mujoco.mj_setConst(m, mujoco.MjData(m)); mujoco.mj_forward(m, d)"
_FIXTURE = """
from mutabot_cell.placing import move_fixture
f = next(one for one in cell.simulation.scene.fixtures if one.name == {name!r})
x, y, z = f.centre
move_fixture(cell.simulation, {name!r}, (x, y, z + AMOUNT), carried={carried})
"""
#: lines that change a cell by AMOUNT, in SI units; for a scale by which FACTOR a number is multiplied
EDITS = {
    "payload": f"""
        for part in cell.simulation.scene.parts:
            b = m.body(part.name).id
            factor = (m.body_mass[b] + AMOUNT) / m.body_mass[b]
            m.body_mass[b] *= factor
            m.body_inertia[b] *= factor
        {_SETTLE}
        """,
    "part x": """
        for part in cell.simulation.scene.parts:
            d.joint(part.name).qpos[0] += AMOUNT
        mujoco.mj_forward(m, d)
        """,
    "grip friction": """
        for p in range(m.npair):
            names = m.geom(int(m.pair_geom1[p])).name, m.geom(int(m.pair_geom2[p])).name
            if any("pad" in name for name in names):
                m.pair_friction[p, :2] *= FACTOR
        """,
    "table height": _FIXTURE.format(name="target table", carried=[]),
    "conveyor height": _FIXTURE.format(name="conveyor", carried=["box"]),
    "conveyor turned": """
        import math
        half, b = math.sin(AMOUNT / 2), m.body("conveyor").id
        m.body_quat[b] = math.cos(AMOUNT / 2), 0, 0, half  # it stands along the world's axes
        for part in cell.simulation.scene.parts:  # which all lie on it
            q, (x, y, _) = d.joint(part.name).qpos, m.body_pos[b]
            arm = complex(q[0] - x, q[1] - y) * complex(math.cos(AMOUNT), math.sin(AMOUNT))
            q[0], q[1] = x + arm.real, y + arm.imag
            whole = complex(q[3], q[6]) * complex(math.cos(AMOUNT / 2), half)  # they lie flat
            q[3], q[6] = whole.real, whole.imag
        mujoco.mj_forward(m, d)
        """,
    "grip force": """
        cell.gripper._force *= FACTOR
        cell.gripper._strength = FACTOR
        m.actuator_forcerange[cell.gripper._servo] *= FACTOR
        """,
    "base x": f"m.body_pos[cell.simulation.robot.body][0] += AMOUNT\n{_SETTLE}",
    "joint 1": "cell.simulation.robot.set_encoder_error([AMOUNT, 0, 0, 0, 0, 0, 0])",
    "joint friction": f"m.dof_frictionloss[cell.simulation.robot.dofs] += AMOUNT\n{_SETTLE}",
    "servo gain": """
        m.actuator_gainprm[cell.simulation.robot.servos, 0] *= FACTOR
        m.actuator_biasprm[cell.simulation.robot.servos, 1] *= FACTOR
        """,
    "vacuum leak": "cell.suction.leak += AMOUNT",
    "belt speed": "cell.belt().drive_factor = FACTOR",
    "belt encoder": "cell.belt().encoder_factor = FACTOR",
    "camera bias": """
        import dataclasses
        seen = cell.sensors.box_position
        cell.sensors.box_position = lambda *names: dataclasses.replace(
            p := seen(*names), x=p.x + AMOUNT
        )
        """,
    "camera scale": """
        import dataclasses
        seen = cell.sensors.box_position
        cell.sensors.box_position = lambda *names: dataclasses.replace(
            p := seen(*names), x=p.x * FACTOR, y=p.y * FACTOR, z=p.z * FACTOR
        )
        """,
    "distance bias": """
        ranged = cell.sensors._range
        cell.sensors._range = lambda: ranged() + AMOUNT
        """,
    "camera latency": """
        s = cell.simulation
        s.set_camera(latency=s.camera_latency + AMOUNT)
        """,
}


@dataclass(frozen=True)
class Judged:
    """What is judged of an example.

    Attributes:
        tests: node ids, short ones.
        parameters: of ``mutabot_cell:world.toml``.
        made: the line of the conftest behind which the lines of an edit stand.
    """

    tests: tuple[str, ...]
    parameters: tuple[str, ...]
    made: str


EXAMPLES = {
    "paper": Judged(
        ("tests/test_mission.py",),
        (
            "payload", "part x", "grip friction", "table height", "conveyor height", "conveyor turned",
            "grip force", "base x", "joint 1", "joint friction", "servo gain",
        ),
        "    with Cell(mutabot_seed) as cell, simulated_time(cell):\n",
    ),
    "pick_and_place": Judged(
        ("tests/test_sorting.py::test_a_box_is_set_down_at_the_place_of_its_colour[red]",),
        ("payload", "part x", "table height", "grip force", "camera bias", "distance bias"),
        "        cell = new_cell(mutabot_seed, scene=Scene(parts=boxes))\n",
    ),
    "tracking": Judged(
        ("tests/test_picking.py::test_a_box_is_picked_from_the_moving_belt_and_set_down_in_time",),
        (
            "payload", "conveyor turned", "belt speed", "belt encoder", "grip force", "camera bias",
            "camera scale", "camera latency",
        ),
        "        cell = new_cell(mutabot_seed, scene=Scene(fixtures=(belt, TARGET_TABLE), parts=boxes))\n",
    ),
    "palletising": Judged(
        (
            "tests/test_palletising.py::"
            "test_a_box_that_lies_at_the_stop_already_is_taken_before_the_belt_runs",
        ),
        ("payload", "part x", "vacuum leak", "distance bias", "servo gain"),
        "            scene=scene(*coming, *stack, *others, pallet=pallet),\n        )\n",
    ),
}  # fmt: skip


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("examples", nargs="*", choices=[*EXAMPLES, []])
    parser.add_argument("--engines", nargs="+", default=list(ENGINES), choices=ENGINES)
    parser.add_argument("--only", nargs="+", default=list(EDITS), choices=EDITS)
    given = parser.parse_args()
    same = other = 0
    for name in given.examples or EXAMPLES:
        began = time.monotonic()
        agree, differ = compare(name, given.engines, set(given.only))
        same, other = same + agree, other + differ
        print(f"{name}: {agree} of {agree + differ} agree, {time.monotonic() - began:.0f} s", flush=True)
    print(f"{same} of {same + other} verdicts agree")
    return 0 if same and not other else 1


def compare(name: str, engines: Sequence[str], only: set[str]) -> tuple[int, int]:
    """Judge an example; print what differs, and return how many verdicts agree and how many do not."""
    what = EXAMPLES[name]
    with tempfile.TemporaryDirectory() as folder:
        results = {}
        for engine in engines:
            copy = copied(ROOT / "examples" / name, Path(folder).resolve() / engine / name)
            configure(copy, what, [parameter for parameter in what.parameters if parameter in only])
            needed = Facts.of(copy).hints.get("plugins", ())
            results[engine] = campaign(request_for(copy, engine, ["world"], 1, needed))
        seeds = seeds_of(results)
        plain: dict[str, str] = {}
        same = other = 0
        for engine, data in results.items():
            for mutant in data["mutants"]:
                id = mutant["id"]
                if id not in plain:
                    copy = copied(ROOT / "examples" / name, Path(folder).resolve() / f"judged {len(plain)}")
                    plain[id] = judged(copy, what, mutant, seeds)
                ours = str(mutant["rounds"][0]["verdict"])
                expected = {"survived": "passes", "no effect": "passes", "killed": "fails"}.get(ours)
                same, other = same + (plain[id] == expected), other + (plain[id] != expected)
                if plain[id] != expected:
                    said = mutant["rounds"][0].get("message") or ""
                    print(f"  [{engine}] {id}: {ours} ({said[:90]}), plain pytest {plain[id]}", flush=True)
    return same, other


def configure(copy: Path, what: Judged, parameters: Sequence[str]) -> None:
    """Let the copy's campaign run these parameters in these tests."""
    file = copy / "pyproject.toml"
    lines = (
        f"tests = {[*what.tests]}",
        "[tool.mutabot.world]",
        'parameters = ["mutabot_cell:world.toml"]',
        f"only = {[*parameters]}",
    )
    # the table of mutabot is the last one of these files
    file.write_text("\n".join([file.read_text(encoding="utf-8"), *lines, ""]), encoding="utf-8")


def judged(copy: Path, what: Judged, mutant: Mapping[str, Any], seeds: Mapping[str, int]) -> str:
    """What plain pytest says of a copy with an edited set-up: ``passes``, ``fails``, or how it ended."""
    test, size = mutant["file"], si(mutant["magnitude"], mutant["unit"])
    signed = -size if mutant["direction"] == "-" else size
    edit = dedent(EDITS[mutant["call"]]).replace("AMOUNT", repr(signed)).replace("FACTOR", repr(1.0 + signed))
    file = copy / "tests" / "conftest.py"
    text = file.read_text(encoding="utf-8")
    if what.made not in text:
        raise SystemExit(f"{file} has no line {what.made!r}")
    tail = what.made.rstrip("\n").rpartition("\n")[2]
    depth = len(tail) - len(tail.lstrip()) + 4 * tail.endswith(":")
    lines = f"import mujoco\nm, d = cell.simulation.model, cell.simulation.data\n{edit.strip()}\n"
    seed = f"\n\n@pytest.fixture\ndef mutabot_seed() -> int:\n    return {seeds[test]}\n"
    file.write_text(text.replace(what.made, what.made + indent(lines, depth * " ")) + seed, encoding="utf-8")
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:mutabot", "-p", "no:cacheprovider", test]
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(words, cwd=copy, env=environment, capture_output=True, text=True, check=False)
    ended = f"exit code {done.returncode}: {done.stdout[-400:]}"
    return {0: "passes", 1: "fails"}.get(done.returncode, ended)


def si(size: float, unit: str | None) -> float:
    """A magnitude in SI units; a part of the whole for percent."""
    factors = {"percent": 0.01, "mm": 1e-3, "ms": 1e-3, "deg": 3.141592653589793 / 180}
    return size * factors.get(unit or "", 1.0)


if __name__ == "__main__":
    sys.exit(main())
