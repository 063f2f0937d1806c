"""The vocabularies that come with mutabot. Whether they fit the packages, ``make shipped`` finds out."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest

from check_shipped import compare
from mutabot.config.vocabulary import load_vocabulary
from mutabot.config.vocabulary.load import shipped_vocabularies
from mutabot.errors import VocabularyError
from mutabot.model import Kind, Vocabulary

DOCS = Path(__file__).parents[3] / "docs" / "vocabulary.md"
URX = "urx.urrobot:URRobot.movel"


def misfits(vocabulary: Vocabulary) -> list[str]:
    """What ``compare`` says, from a process of its own: it wraps what it compares."""
    with ProcessPoolExecutor(1, get_context("fork")) as pool:
        return pool.submit(_compared, vocabulary).result()


def _compared(vocabulary: Vocabulary) -> list[str]:
    return list(compare(vocabulary))


@pytest.mark.parametrize("name", shipped_vocabularies())
def test_it_loads_and_is_documented(name: str, tmp_path: Path) -> None:
    assert load_vocabulary([name], tmp_path).operations
    assert f"| `{name}` |" in DOCS.read_text(encoding="utf-8")


@pytest.mark.parametrize("names", [["urx", "own.toml"], ["own.toml", "urx"]])
def test_a_file_of_ones_own_goes_before_a_shipped_one(names: list[str], tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(
        f'[[operation]]\ncall = "{URX}"\n'
        'arguments."tpose[2]" = { kind = "translation", axis = "z", unit = "m", mode = "by" }\n'
    )
    found = {operation.target: operation for operation in load_vocabulary(names, tmp_path).operations}
    assert [argument.name for argument in found[URX].arguments] == ["tpose[2]"]
    assert len(found) == len(load_vocabulary(["urx"], tmp_path).operations)


@pytest.mark.needs("cell")
def test_the_clock_and_probes_of_ones_own_go_before_shipped_ones(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(
        'clock = { tick = "pybullet:stepSimulation", step = 0.01 }\n'
        '[[probe]]\ncall = "mutabot_cell:world"\ntolerance = 0.5\n'
    )
    found = load_vocabulary(["cell", "own.toml"], tmp_path)
    assert found.clock is not None
    assert found.clock.tick == "pybullet:stepSimulation"
    assert [probe.tolerance for probe in found.probes] == [0.5]


def test_a_probe_takes_angles_and_orientations_from_the_operation_of_its_callable(tmp_path: Path) -> None:
    operation = (
        '[[operation]]\ncall = "arm:Arm.pose"\n'
        'result."[0:3]" = { kind = "position", axis = "xyz", unit = "m" }\n'
        'result."[3:6]" = { kind = "rotation_vector", unit = "rad" }\n'
    )
    probe = '[[probe]]\ncall = "arm:Arm.pose"\n'
    own = 'result."[0:3]" = { kind = "euler", order = "xyz", unit = "deg" }\n'
    for text, names in ((probe, ["[3:6]"]), (probe + own, ["[0:3]"])):
        (tmp_path / "robot.toml").write_text(operation + text)
        (found,) = load_vocabulary(["robot.toml"], tmp_path).probes
        assert [part.name for part in found.result] == names


def test_two_files_of_ones_own_still_may_not_disagree(tmp_path: Path) -> None:
    for name, axis in (("a.toml", "x"), ("b.toml", "y")):
        quantity = f'{{ kind = "translation", axis = "{axis}", unit = "m", mode = "by" }}'
        (tmp_path / name).write_text(f'[[operation]]\ncall = "{URX}"\narguments."tpose[0]" = {quantity}\n')
    with pytest.raises(VocabularyError, match="described twice, differently"):
        load_vocabulary(["a.toml", "urx", "b.toml"], tmp_path)


@pytest.mark.needs("cell")
def test_the_cell_that_comes_with_mutabot_has_what_its_vocabulary_says(tmp_path: Path) -> None:
    assert misfits(load_vocabulary(["cell"], tmp_path)) == []


def test_what_a_package_does_not_have_is_found(tmp_path: Path) -> None:
    (tmp_path / "wrong.toml").write_text(
        '[[operation]]\ncall = "json:JSONEncoder.encode"\n'
        'arguments.height = { kind = "translation", axis = "z", unit = "m", mode = "by" }\n'
        '[[operation]]\ncall = "json:JSONEncoder.lift"\n'
    )
    found = misfits(load_vocabulary(["wrong.toml"], tmp_path))
    assert len(found) == 2
    assert any("has no argument 'height'" in problem for problem in found)
    assert any("has no 'lift'" in problem for problem in found)


def parts_of(name: str, call: str, folder: Path) -> dict[str, list[str]]:
    """What a shipped vocabulary says of a call: its quantities with kind and unit, by the case it is in."""
    operation = load_vocabulary([name], folder).operation(call)
    assert operation is not None
    cases = [(pattern.text, (*pattern.arguments, *pattern.result)) for pattern in operation.patterns]
    found = cases or [("", (*operation.arguments, *operation.result))]
    return {
        text: [f"{quantity.name} {quantity.kind} {quantity.unit}" for quantity in quantities]
        for text, quantities in found
    }


def test_pybullet_has_both_places_of_a_link(tmp_path: Path) -> None:
    """People read the centre of mass as well as the frame."""
    (parts,) = parts_of("pybullet", "pybullet:getLinkState", tmp_path).values()
    positions = [f"[{index}][{axis}] position m" for index in (0, 4) for axis in range(3)]
    assert set(parts) == {*positions, "[1][0:4] quaternion None", "[5][0:4] quaternion None"}


def test_a_motor_of_pybullet_gets_what_its_mode_names(tmp_path: Path) -> None:
    assert parts_of("pybullet", "pybullet:setJointMotorControl2", tmp_path) == {
        "controlMode=0": ["targetVelocity speed rad/s"],
        "controlMode=1": ["force torque Nm"],
        "controlMode=2": ["targetPosition rotation rad"],
        "controlMode=3": ["targetPosition rotation rad"],
    }


def test_xarm_is_in_the_units_that_the_call_says(tmp_path: Path) -> None:
    found = parts_of("xarm", "xarm.wrapper.xarm_api:XArmAPI.get_servo_angle", tmp_path)
    units = {text: {part.rpartition(" ")[2] for part in parts} for text, parts in found.items()}
    assert len(units) == 8
    for text, unit in units.items():
        is_radian = "is_radian=true" in text
        assert unit == ({"rad"} if is_radian else {"deg"})


@pytest.mark.parametrize("name", ["ur_rtde", "urx"])
def test_the_orientations_of_universal_robots_are_rotation_vectors(name: str, tmp_path: Path) -> None:
    """They mean something only as a whole; only joints turn about an axis each."""
    for operation in load_vocabulary([name], tmp_path).operations:
        patterns = [(*pattern.arguments, *pattern.result) for pattern in operation.patterns]
        for quantity in (
            part for parts in [(*operation.arguments, *operation.result), *patterns] for part in parts
        ):
            if quantity.kind in (Kind.ROTATION, Kind.ORIENTATION) and (quantity.axis or "").startswith(
                ("x", "y", "z")
            ):
                assert quantity.name == "result", f"{operation.target}: {quantity.name}"
