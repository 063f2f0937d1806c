"""``mutabot init`` on robot programs without tests: a cell map, tests that run, and a configuration."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from mutabot_init.layout import other_files
from mutabot_init.proposers import started
from mutabot_languages import load
from mutabot_languages.registry import language_for
from mutabot_languages.starting import project as starting
from mutabot_languages.starting.signals import signals_of
from mutabot_languages.starting.trial import ProgramTrial
from tests.command import mutabot
from tests.packages.languages.programs import FILES, written

UP = """MODULE Up
  VAR robtarget pNow;
  PROC main()
    pNow:=CRobT();
    MoveL Offs(pNow,0,0,50), v200, fine, tool0;
    Set doGrip;
    WaitDI diHolding, 0;
  ENDPROC
ENDMODULE
"""


def begun(
    folder: Path, monkeypatch: pytest.MonkeyPatch, found: ProgramTrial
) -> tuple[dict[str, str], list[str]]:
    monkeypatch.setattr(starting, "tried", lambda files, cell_map, missing: found)
    made = started(folder, other_files(folder, []))
    assert made is not None
    return made


@pytest.mark.usefixtures("plugins")
def test_init_makes_a_project_whose_tests_pass_and_that_mutabot_lists(tmp_path: Path) -> None:
    (tmp_path / "up.mod").write_text(UP)
    assert "up.mod ends after" in mutabot(tmp_path, "init").stdout
    tests = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    ended = subprocess.run(tests, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stdout
    assert tomllib.loads((tmp_path / "mutabot.toml").read_text())["program"] == ["up.mod"]
    assert "Offs(pNow,0,0,-50)" in mutabot(tmp_path, "diff", "reverse-offset").stdout


@pytest.mark.parametrize("language", FILES)
def test_the_cell_map_names_the_signals_that_a_program_uses(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, language: str
) -> None:
    written(tmp_path, language)
    files, lines = begun(tmp_path, monkeypatch, ProgramTrial("gen3", 1.0, (0, 0, 0), (0, 0, 0)))
    cell_map = tomllib.loads(files["cell_map.toml"])
    output, signal = {
        "urscript": ("standard_digital_out[0]", "standard_digital_in[3]"),
        "rapid": ("grip", "part"),
        "krl": ("$OUT[9]", "$IN[25]"),
    }[language]
    assert cell_map["out"] == {output: {"gripper": [0, 1]}}
    assert [*cell_map["in"]] == [signal]
    assert tomllib.loads(files["mutabot.toml"])["program"] == sorted(FILES[language], reverse=True)
    assert language in lines[0]


def test_what_a_program_waits_for_is_what_the_input_says(tmp_path: Path) -> None:
    text = "DEF a( )\nWAIT FOR $IN[1]==FALSE\nWAIT FOR $IN[2]\nSIGNAL LAMP $OUT[1]\n$OUT[2]=TRUE\nEND\n"
    language = language_for("a.src")
    assert language is not None
    found = {signal.name: signal for signal in signals_of([language.read("a.src", text)], "krl")}
    assert [found[name].value for name in ("$IN[1]", "$IN[2]")] == [False, True]
    assert found["$OUT[1]"].meaning == "lamp"
    assert '# [out."$OUT[1]"]' in starting.cell_map_text("a.src", [*found.values()])


def test_modules_of_rapid_are_one_program_that_begins_in_the_one_with_main(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.mod").write_text("MODULE A\nPROC grip()\nSet doGrip;\nENDPROC\nENDMODULE\n")
    (tmp_path / "b.mod").write_text("MODULE B\nPROC main()\ngrip;\nENDPROC\nENDMODULE\n")
    files, _ = begun(tmp_path, monkeypatch, ProgramTrial("ur5e", 61.0, (0, 0, 0), (0, 0, 0)))
    test = files["tests/test_b.py"]
    assert 'load(ROOT / "b.mod", ROOT / "a.mod")' in test
    assert "robots.ur5e()" in test
    assert "until=lambda: cell.time > 60" in test
    compile(test, "test_b.py", "exec")


def test_files_belong_to_the_program_that_calls_them_wherever_they_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    texts = {
        "main.src": "DEF main( )\nStep_1( )\nPTP home\nEND\n",
        "sub/Step_1().src": "DEF Step_1( )\nBAS(#TOOL,1)\nEND\n",
        "sub/step_2.src": "DEF step_2( )\nEND\n",
        "copy/main.src": "DEF main( )\nStep_1( )\nEND\nDEF Step_1( )\nEND\n",
        "system/$config.dat": "DEFDAT $CONFIG\nDECL E6AXIS HOME={A1 0,A2 -90}\nENDDAT\n",
        "system/bas.src": "DEF bas(a:IN)\nEND\n",
        "mesh.dat": "12 13 14\n",
    }
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(text.replace("\n", "\r\n").encode("latin-1"))
    files, lines = begun(tmp_path, monkeypatch, ProgramTrial("gen3", 1.0, (0, 0, 0), (0, 0, 0)))
    program = ["main.src", "sub/Step_1().src", "system/$config.dat"]
    assert sorted(tomllib.loads(files["mutabot.toml"])["program"]) == program
    assert lines[-1].startswith("left out, as main.src needs nothing of them: copy/main.src, mesh.dat,")


def test_a_copy_of_a_module_beside_it_is_no_part_of_the_program(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a.mod", "b - Copy.mod"):
        (tmp_path / name).write_text(
            "MODULE A\nPROC main()\ngrip;\nENDPROC\nPROC grip()\nENDPROC\nENDMODULE\n"
        )
    files, lines = begun(tmp_path, monkeypatch, ProgramTrial("gen3"))
    assert tomllib.loads(files["mutabot.toml"])["program"] == ["a.mod"]
    assert "it does nothing in the cell: name the file that does: mutabot init FILE…" in lines


def test_why_a_program_does_not_run_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.script").write_text("socket_open('a', 1)\n")
    problem = "UnsupportedError: unsupported: socket_open at line 1 of a.script"
    files, lines = begun(tmp_path, monkeypatch, ProgramTrial("gen3", problem=problem))
    assert (
        "a.script does not run to its end on the cell: unsupported: socket_open at line 1 of a.script"
        in lines
    )
    assert "program.run(cell)" in files["tests/test_a.py"]


@pytest.mark.parametrize(
    ("problem", "hint"),
    [
        ("ProgramError: a.script:1: movej(p): unreachable: no joint angles", "none of the arms gen3, ur5e, "),
        (
            "MotionRefused: a.script:1: movel(p): out of reach",
            "none of the arms gen3, ur5e, ",
        ),
        (
            "ProtectiveStop: a.script:1: movel(p): protective stop at t=1 s: it touched the conveyor",
            "none of the arms gen3, ur5e, ",
        ),
        ("UnsupportedError: unsupported: socket_open at line 1", "say in cell_map.toml, in the test or in "),
    ],
)
def test_what_to_do_is_said_by_what_stopped_it(
    problem: str, hint: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.script").write_text("movej(p)\n")
    _, lines = begun(tmp_path, monkeypatch, ProgramTrial("gen3", problem=problem))
    assert lines[-1].startswith(hint)


def test_tests_and_cell_maps_that_are_there_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written(tmp_path, "rapid")
    (tmp_path / "cell_map.toml").write_text("")
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_it.py").write_text("def test_it(): pass\n")
    files, _ = begun(tmp_path, monkeypatch, ProgramTrial("gen3"))
    assert [*files] == ["mutabot.toml"]


def test_a_python_program_beside_is_the_program(tmp_path: Path) -> None:
    written(tmp_path, "rapid")
    (tmp_path / "robot.py").write_text("")
    assert other_files(tmp_path, []) == []
    assert other_files(tmp_path, [tmp_path / "pick.mod"]) == [tmp_path / "pick.mod"]


def test_a_program_that_was_started_is_loaded_with_its_cell_map(tmp_path: Path) -> None:
    written(tmp_path, "rapid")
    (tmp_path / "cell_map.toml").write_text('[out."grip"]\ngripper = [0, 1]\n')
    assert load(tmp_path / "pick.mod").cell_map.outputs == {"grip": {"gripper": [0, 1]}}


LACKING = """MODULE A
  PROC main()
    VAR robtarget pUp;
    pUp:=Offs(CRobT(\\Tool:=tCalibrated \\WObj:=wobj0),0,0,20);
    MoveL pUp,v200,fine,tGrip\\WObj:=wTable;
    MoveC pUp,pUp,v200,fine,tGrip;
    MoveLDO pUp,v200,fine,tOther,doGrip,1;
  ENDPROC
  PROC other(PERS tooldata tGiven)
    MoveJ CRobT(),v200,fine,tGiven;
  ENDPROC
ENDMODULE
"""


def test_tools_and_work_objects_that_no_file_declares_are_drafted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.mod").write_text(LACKING)
    files, lines = begun(tmp_path, monkeypatch, ProgramTrial("gen3", 1.0, (0, 0, 0), (0, 0, 0)))
    draft = files["MissingData.mod"]
    assert [line.split()[1:3] for line in draft.splitlines()[2:-1]] == [
        ["tooldata", "tcalibrated:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];"],
        ["tooldata", "tgrip:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];"],
        ["wobjdata", 'wtable:=[FALSE,TRUE,"",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];'],
        ["tooldata", "tother:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];"],
    ]
    assert tomllib.loads(files["mutabot.toml"])["program"] == ["a.mod", "MissingData.mod"]
    assert 'load(ROOT / "a.mod", ROOT / "MissingData.mod")' in files["tests/test_a.py"]
    assert lines[1].startswith("drafted in MissingData.mod, as no file declares it: tcalibrated, tgrip, ")


def test_a_program_runs_with_what_was_drafted_for_it(tmp_path: Path) -> None:
    (tmp_path / "a.mod").write_text(LACKING.replace("MoveC", "! MoveC"))
    made = started(tmp_path, other_files(tmp_path, []))
    assert made is not None
    assert "a.mod ends after" in made[1][2]


@pytest.mark.parametrize(
    ("config", "drafted"),
    [("", ["PDEFAULT=", "XHOME="]), ("DEFDAT $CONFIG\nDECL E6AXIS XHOME={A1 0}\nENDDAT\n", None)],
)
def test_what_each_controller_of_krl_declares_is_drafted_unless_its_file_is_there(
    config: str, drafted: list[str] | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.src").write_text("DEF a( )\nPDAT_ACT=PDEFAULT\nPTP XHOME\nEND\n")
    if config:
        (tmp_path / "$config.dat").write_text(config)
    files, _ = begun(tmp_path, monkeypatch, ProgramTrial("gen3", 1.0, (0, 0, 0), (0, 0, 0)))
    text = files.get("$config.dat")
    assert (text and [line.split()[2].partition("{")[0] for line in text.splitlines()[2:-1]]) == drafted
