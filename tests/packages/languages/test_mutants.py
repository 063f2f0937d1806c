"""Mutants of the text: each is a difference of one line that reads clean, and has a verdict."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from mutabot.campaign.suppressions import comments_in
from mutabot_languages.mutation.planning import PlannedText, mutants_of, planned_texts, read_program
from mutabot_languages.mutation.rewriting import Sizes
from mutabot_languages.mutation.rules import BY_NAME, FAMILY
from tests.command import mutabot
from tests.packages.languages.programs import FILES, RAPID, written

pytestmark = pytest.mark.usefixtures("forks")


def planned(folder: Path, language: str) -> list[PlannedText]:
    written(folder, language)
    return [*planned_texts(folder, [*FILES[language]])]


def described(found: list[PlannedText], operator: str) -> list[str]:
    return [
        planned_text.description for planned_text in found if planned_text.difference.operator == operator
    ]


@pytest.mark.parametrize("language", FILES)
def test_each_changes_one_line_and_reads_as_well_as_the_original(language: str, tmp_path: Path) -> None:
    found = planned(tmp_path, language)
    assert len(found) > 80
    for planned_text in found:
        diff = planned_text.program.diff(planned_text.difference)
        assert [line[0] for line in diff[2:]] == ["@", "-", "+"], diff
        changed = planned_text.program.changed(planned_text.difference)
        assert planned_text.program.language.read("", changed).diagnostics == ()
        kept = planned_text.program.text
        for edit in sorted(planned_text.difference.edits, key=lambda edit: -edit.start):
            kept = kept[: edit.start] + edit.text + kept[edit.end :]
        assert kept == changed


@pytest.mark.parametrize("language", FILES)
def test_ids_are_different(language: str, tmp_path: Path) -> None:
    found = planned(tmp_path, language)
    keys = [
        (
            planned_text.site.id,
            planned_text.difference.operator,
            planned_text.difference.variant,
            planned_text.difference.magnitude,
        )
        for planned_text in found
    ]
    assert len(keys) == len(set(keys))


def test_they_read_as_an_engineer_would_write_them(tmp_path: Path) -> None:
    rapid, krl, script = (planned(tmp_path, language) for language in ("rapid", "krl", "urscript"))
    assert described(rapid, "reverse-offset") == ["Offs(pOver,0,0,-100) → Offs(pOver,0,0,100)"]
    assert "WAIT FOR $IN[25]==TRUE → WAIT SEC 0" in described(krl, "forget-wait")
    assert "PTP XP1 C_PTP deleted" in described(krl, "drop-statement")
    assert "movej(over, a=1.4, v=1.05) → movel(over)" in described(script, "swap-motion")
    assert "WaitDI part, 1\\MaxTime:=2 → WaitDI part, 0\\MaxTime:=2" in described(rapid, "invert-input")
    blends = [
        planned_text for planned_text in (*rapid, *krl) if planned_text.difference.operator == "change-blend"
    ]
    assert blends
    assert all("cannot be observed" in (planned_text.difference.reason or "") for planned_text in blends)


def test_every_operator_is_one_that_is_declared_and_most_have_mutants(tmp_path: Path) -> None:
    used = {
        planned_text.difference.operator for language in FILES for planned_text in planned(tmp_path, language)
    }
    assert used <= set(BY_NAME)
    robot = {rule.name for rule in BY_NAME.values() if rule.family == FAMILY}
    assert robot - used <= {"other-input"}


@pytest.mark.parametrize(
    ("name", "text", "changes"),
    [
        (
            "a.src",
            "DEF a()\nWAIT FOR $IN[3]\nWAIT FOR $IN[7]\nWAIT FOR $IN[3]\n$OUT[9]=TRUE\nEND\n",
            ["$IN[3] → $IN[7]", "$IN[7] → $IN[3]", "$IN[3] → $IN[7]"],
        ),
        ("a.src", "DEF a()\nWAIT FOR $IN[3]\nEND\n", []),
        (
            "a.script",
            "x = get_standard_digital_in(1)\ny = get_standard_digital_in(0)\nz = get_tool_digital_in(1)\n",
            [
                "get_standard_digital_in(1) → get_standard_digital_in(0)",
                "get_standard_digital_in(0) → get_standard_digital_in(1)",
            ],
        ),
    ],
)
def test_another_input_is_one_that_the_program_reads(
    name: str, text: str, changes: list[str], tmp_path: Path
) -> None:
    (tmp_path / name).write_text(text)
    assert described([*planned_texts(tmp_path, [name])], "other-input") == changes


@pytest.mark.parametrize("function", ["pose_trans", "pose_add", "pose_sub"])
def test_an_offset_of_a_script_goes_the_other_way_and_only_a_frame_is_lost(
    function: str, tmp_path: Path
) -> None:
    (tmp_path / "a.script").write_text(f"movel({function}(here, p[0, 0, 0.1, 0, 0, 0]))\n")
    found = [*planned_texts(tmp_path, ["a.script"])]
    (turned,) = described(found, "reverse-offset")
    assert f"{function}(here, p[0, 0, -0.1, 0, 0, 0])" in turned
    assert len(described(found, "other-frame")) == (1 if function == "pose_trans" else 0)


def test_what_inline_forms_and_the_ini_fold_write_has_none(tmp_path: Path) -> None:
    assert not [
        planned_text for planned_text in planned(tmp_path, "krl") if "bas" in planned_text.description.lower()
    ]


def test_another_magnitude_is_made_of_the_same_fault(tmp_path: Path) -> None:
    written(tmp_path, "rapid")
    (program,) = read_program(tmp_path, ["pick.mod"])
    found = [
        planned_text.description
        for planned_text in mutants_of(program, Sizes.only(7.5))
        if planned_text.difference.operator == "shift-target" and planned_text.difference.variant == "z-"
    ]
    assert "Offs(pOver,0,0,-107.5)" in found[1]


TEST = """
from pathlib import Path
import pytest
from mutabot_languages import load

def test_pick(new_cell, mutabot_seed):
    cell = new_cell(mutabot_seed)
    load(Path(__file__).parent / "pick.src").run(cell, inputs={"$IN[25]": True})
    pose = cell.truth.tool_pose()
    assert (pose.x, pose.y, pose.z) == pytest.approx((0.5, 0.2, 0.3), abs=0.01)
"""


@pytest.mark.whole
@pytest.mark.parametrize("engine", ["fork", "replay"])
def test_they_have_verdicts(engine: str, tmp_path: Path) -> None:
    written(tmp_path, "krl")
    (tmp_path / "conftest.py").write_text("from mutabot_cell.fixtures import *\n")
    (tmp_path / "test_pick.py").write_text(TEST)
    settings = 'program = ["pick.src", "pick.dat"]\nvocabulary = ["cell"]\ntests = ["test_pick.py"]\n'
    settings += 'families = ["program-text"]\n'
    (tmp_path / "pyproject.toml").write_text(f"[tool.mutabot]\n{settings}")
    only = ["shift-point", "drop-statement", "swap-motion", "forget-wait"]
    options = [word for name in only for word in ("--only", name)]
    done = mutabot(tmp_path, "run", "--json", "--engine", engine, "-o", "repeats=false", *options)
    assert done.returncode == 0, done.stderr
    found = {mutant["description"]: mutant["rounds"][0] for mutant in json.loads(done.stdout)["mutants"]}
    verdicts = {text: end["verdict"] for text, end in found.items()}
    assert {end["engine"] for end in found.values()} == {engine}
    assert verdicts["LIN XP1 deleted"] == "killed"
    assert verdicts["LIN XP1 → PTP XP1"] == "survived"
    assert verdicts["WAIT FOR $IN[25]==TRUE → WAIT SEC 0"] == "survived"


#: one does not come to a statement of its own; in the other, a value may be missing
SHORT = {
    "a.script": "x = 1\nif x > 1:\n  x = x + 5\nend\nsleep(0.1)\n",
    "b.script": "y = 1\nz = y + 1\ny = z\n",
}
SHORT_TESTS = """
from pathlib import Path
from mutabot_languages import load

def test_a(new_cell):
    assert load(Path(__file__).parent / "a.script").run(new_cell(1)).variables["x"] == 1

def test_b(new_cell):
    assert load(Path(__file__).parent / "b.script").run(new_cell(1)).variables["z"] == 2
"""


@pytest.fixture(scope="module", params=["fork", pytest.param("replay", marks=pytest.mark.whole)])
def short(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """How each mutant of two short programs ends, by its description."""
    folder = tmp_path_factory.mktemp("short")
    for name, text in SHORT.items():
        (folder / name).write_text(text)
    (folder / "conftest.py").write_text("from mutabot_cell.fixtures import *\n")
    (folder / "test_short.py").write_text(SHORT_TESTS)
    settings = f'program = {[*SHORT]}\nvocabulary = ["cell"]\ntests = ["test_short.py"]\n'
    (folder / "mutabot.toml").write_text(f'{settings}families = ["program-conventional"]\n')
    done = mutabot(folder, "run", "--json", "--engine", request.param, "-o", "repeats=false")
    return {mutant["description"]: mutant["rounds"][0] for mutant in json.loads(done.stdout)["mutants"]}


def test_what_the_program_does_not_come_to_is_not_covered(short: dict[str, Any]) -> None:
    assert short["x + 5 → x - 5"]["verdict"] == "not covered"
    assert short["x > 1 → x >= 1"]["verdict"] == "killed"


def test_a_variable_that_has_lost_its_value_is_an_error_of_the_program(short: dict[str, Any]) -> None:
    assert short["y = 1 deleted"]["verdict"] == "killed"
    assert "b.script:2: y has no value" in short["y = 1 deleted"]["message"]
    assert short["y = z deleted"]["verdict"] == "survived"


def test_diff_and_export_show_and_write_them(tmp_path: Path) -> None:
    written(tmp_path, "krl")
    (tmp_path / "pyproject.toml").write_text(
        '[tool.mutabot]\nprogram = ["pick.src", "pick.dat"]\nvocabulary = ["cell"]\ntests = ["."]\n'
    )

    shown = mutabot(tmp_path, "diff").stdout
    assert ":forget-wait\n" in shown
    assert ":drop-any\n" not in shown  # of a family that is not asked for
    shown = mutabot(tmp_path, "diff", "forget-wait").stdout.splitlines()
    assert shown[0] == "# pick.src:pick:wait for#1:forget-wait"
    assert shown[-2:] == ["-WAIT FOR $IN[25]==TRUE", "+WAIT SEC 0"]
    assert mutabot(tmp_path, "export", "out", "forget-wait").returncode == 0
    original = (tmp_path / "pick.src").read_bytes()
    exported = (tmp_path / "out/1/pick.src").read_bytes()
    assert exported == original.replace(b"WAIT FOR $IN[25]==TRUE", b"WAIT SEC 0")
    assert (tmp_path / "out/1/pick.dat").read_bytes() == (tmp_path / "pick.dat").read_bytes()
    assert "is not empty" in mutabot(tmp_path, "export", "out").stderr
    for words in (
        ("--only", "1"),
        ("--rounds", "1"),
        ("--sample", "10%"),
    ):  # nothing runs, nothing has a number
        refused = mutabot(tmp_path, "diff", *words)
        assert refused.returncode == 2
        assert f"No such option: {words[0]}" in refused.stderr


def test_a_printed_difference_has_the_bytes_of_its_file_so_that_patch_takes_it(tmp_path: Path) -> None:
    text = RAPID.replace("WaitTime 0.5;", "WaitTime 0.5; ! Größe").replace("\n", "\r\n")
    (tmp_path / "pick.mod").write_bytes(text.encode("latin-1"))
    settings = 'program = ["pick.mod"]\nvocabulary = ["cell"]\ntests = ["."]\n'
    (tmp_path / "mutabot.toml").write_text(settings)
    command = [sys.executable, "-m", "mutabot", "-C", str(tmp_path), "diff", "scale-wait"]
    shown = subprocess.run(command, capture_output=True, check=True).stdout.split(b"\n")
    assert b"-    WaitTime 0.5; ! Gr\xf6\xdfe\r" in shown
    assert b"+    WaitTime 0.05; ! Gr\xf6\xdfe\r" in shown


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.mod", "PROC main()\r\n! mutabot: accept skip: why\r\nWaitTime 1; ! mutabot: accept *: why\r\n"),
        ("a.src", "DEF a()\r\n; mutabot: accept skip: why\r\nWAIT SEC 1 ; mutabot: accept *: why\r\n"),
        ("a.script", "def a():\r\n# mutabot: accept skip: why\r\nsleep(1) # mutabot: accept *: why\r\n"),
    ],
)
def test_a_comment_in_the_program_s_own_language_accepts_mutants_of_its_line(name: str, text: str) -> None:
    found = comments_in(name, text)
    assert [(finding.operator, finding.numbers, finding.why) for finding in found] == [
        ("skip", (3, 3), "why"),
        ("*", (3, 3), "why"),
    ]
