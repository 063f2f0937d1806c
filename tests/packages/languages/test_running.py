"""Programs run on the cell: the same task in three languages, signals, threads, errors, and what is said."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from mutabot_cell import Cell
from mutabot_languages import LanguageError, ProgramError, UnsupportedError, load
from mutabot_languages.core.frames import Frame
from tests.packages.languages.programs import FILES, INPUTS, run, written


def test_the_same_task_ends_at_the_same_pose_in_all_languages(tmp_path: Path) -> None:
    ends = []
    for language in FILES:
        cell = Cell(seed=1, noise=False)
        load(written(tmp_path, language)).run(cell, inputs=INPUTS)
        pose = cell.truth.tool_pose()
        ends.append((pose.x, pose.y, pose.z))
    assert ends[0] == pytest.approx((0.5, 0.2, 0.3), abs=0.0005)
    assert all(math.dist(ends[0], end) < 0.0005 for end in ends)


def test_outputs_move_the_gripper_as_the_cell_map_says(tmp_path: Path) -> None:
    (tmp_path / "cell_map.toml").write_text("[out.grip]\ngripper = [0, 1]\n[in.part]\nholding = false\n")
    text = "MODULE M\nPROC main()\nSet grip;\nWaitTime 1;\nb:=TestDI(part);\nENDPROC\nVAR bool b;\nENDMODULE"
    cell, ended = run(tmp_path, "m.mod", text)
    assert cell.truth.opening() < 0.01
    assert ended.variables["b"] is True
    assert ended.seconds == pytest.approx(1.0, abs=0.02)


def test_an_input_that_nobody_explains_is_an_error_that_says_how(tmp_path: Path) -> None:
    with pytest.raises(UnsupportedError, match=r"\[in\.\"standard_digital_in\[2\]\"\]"):
        run(tmp_path, "a.script", "x = get_standard_digital_in(2)\n")


def test_threads_take_turns_by_the_seed_and_motions_go_on_meanwhile(tmp_path: Path) -> None:
    text = """
def prog():
  global count = 0
  thread counter():
    while True:
      count = count + 1
      sleep(0.1)
    end
  end
  t = run counter()
  movej([0.3, 0.2618, 3.14159, -2.2689, 0, 0.9599], v=0.5)
  kill t
  global seen = count
  sleep(0.5)
end
"""
    _, ended = run(tmp_path, "a.script", text)
    assert ended.variables["seen"] > 5
    assert ended.variables["count"] == ended.variables["seen"]
    assert run(tmp_path, "a.script", text, seed=0)[1].seconds == ended.seconds


def test_an_error_handler_of_rapid_tries_again_or_goes_on(tmp_path: Path) -> None:
    text = """MODULE M
      VAR num tried:=0;
      VAR num after:=0;
      PROC main()
        WaitDI di, 1\\MaxTime:=0.1;
        after:=1;
        ERROR
          tried:=tried+1;
          IF ERRNO=ERR_WAIT_MAXTIME AND tried<3 RETRY;
          TRYNEXT;
      ENDPROC
    ENDMODULE"""
    _, ended = run(tmp_path, "m.mod", text, inputs={"di": 0})
    assert (ended.variables["tried"], ended.variables["after"]) == (3, 1)
    assert ended.seconds == pytest.approx(0.3, abs=0.05)


def test_arguments_of_krl_are_the_callers_own_variables(tmp_path: Path) -> None:
    text = """DEF m()
INT n
n=2
add(n, 3)
total=n*2
END
DEF add(to_it:OUT, what:IN)
INT to_it, what
to_it=to_it+what
END
"""
    (tmp_path / "m.dat").write_text("DEFDAT M\nDECL INT total=0\nENDDAT\n")
    _, ended = run(tmp_path, "m.src", text)
    assert ended.variables["total"] == 10


def test_data_that_cannot_be_declared_is_an_error_only_where_it_is_used(tmp_path: Path) -> None:
    data = 'DEFDAT M\nDECL CHAR T[8]\nT[]="text"\nDECL INT later=missing+1\nDECL INT n=2\nENDDAT\n'
    (tmp_path / "m.dat").write_text(data)
    _, ended = run(tmp_path, "m.src", "DEF m()\nn=n+1\nEND\n")
    assert (ended.variables["n"], ended.variables["t"]) == (3, "text")
    with pytest.raises(UnsupportedError, match=r"later: unsupported: missing at line 4 of m\.dat"):
        run(tmp_path, "m.src", "DEF m()\nn=later\nEND\n")


@pytest.mark.parametrize(
    ("name", "text", "what"),
    [
        ("a.script", 'x = 1\nsocket_open("1.2.3.4", 1)\n', "unsupported: socket_open at line 2 of a.script"),
        (
            "a.mod",
            "MODULE M\nPROC main()\nEGMStop 1;\nENDPROC\nENDMODULE",
            "unsupported: egmstop at line 3 of a.mod",
        ),
        ("a.src", "DEF a()\nRSI_ON(#RELATIVE)\nEND", "unsupported: rsi_on at line 2 of a.src"),
    ],
)
def test_what_is_not_carried_out_is_said_by_name_and_line(
    tmp_path: Path, name: str, text: str, what: str
) -> None:
    with pytest.raises(UnsupportedError) as caught:
        run(tmp_path, name, text)
    assert str(caught.value) == f"{what}, which no loaded file declares"


def test_what_has_no_effect_is_noted(tmp_path: Path) -> None:
    _, ended = run(tmp_path, "a.script", 'textmsg("hello")\n')
    assert ended.notes == ("textmsg at line 1 has no effect here",)


def test_a_tool_that_no_file_declares_may_be_in_another_file(tmp_path: Path) -> None:
    text = "MODULE M\nPROC main()\nMoveL Offs(CRobT(),0,0,9),v50,fine,tGrip;\nENDPROC\nENDMODULE"
    with pytest.raises(
        UnsupportedError, match=r"^m.mod:3: nothing says what tgrip is: load the file that decl"
    ):
        run(tmp_path, "m.mod", text)


def test_a_script_whose_functions_take_arguments_runs_what_stands_beside_them(tmp_path: Path) -> None:
    _, ended = run(tmp_path, "a.script", "def f(k):\n  sleep(k)\nend\nx = 2\n")
    assert (ended.variables["x"], ended.seconds) == (2, 0)


def test_pytest_shows_nothing_of_the_machine_where_a_program_stops(tmp_path: Path) -> None:
    (tmp_path / "a.script").write_text("def a():\n  b = 1 / 0\nend\n")
    with pytest.raises(ProgramError) as caught:
        load(tmp_path / "a.script").run(Cell(seed=1))
    shown = caught.traceback.filter(caught)
    assert {Path(entry.path).name for entry in shown} == {"test_running.py"}


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        (
            "a.src",
            "DEF a()\nPTP home\nEND",
            "unsupported: home at line 2 of a.src, which no loaded file declares",
        ),
        (
            "a.mod",
            "MODULE A\nPROC main()\nIF TestDI(di1) Stop;\nENDPROC\nENDMODULE",
            "a.mod:3: nothing says what di1 is",
        ),
        (
            "a.script",
            "def a(b):\n  sleep(b)\nend\n",
            "a.script: nothing stands at its top, and each of its functions",
        ),
        ("a.src", "DEF b()\nWAIT SEC 0\n", "there is no routine 'c'; there are: b"),
    ],
)
def test_what_a_program_lacks_is_said(tmp_path: Path, name: str, text: str, message: str) -> None:
    routine = "c" if "'c'" in message else ""
    (tmp_path / name).write_text(text)
    with pytest.raises(LanguageError, match=message):
        load(tmp_path / name).run(Cell(), routine)


def test_the_last_function_without_arguments_of_a_file_of_functions_runs(tmp_path: Path) -> None:
    text = "def go():\n  blink(0.2)\nend\ndef blink(t):\n  sleep(t)\nend\n"
    assert run(tmp_path, "a.script", text)[1].seconds == pytest.approx(0.2, abs=0.02)


def test_a_program_that_never_ends_is_stopped_and_one_with_an_end_is_not(tmp_path: Path) -> None:
    text = "DEF a()\nLOOP\nWAIT SEC 0.1\nENDLOOP\nEND"
    with pytest.raises(ProgramError, match="is not over after 1 s"):
        run(tmp_path, "a.src", text, limit=1.0)
    cell = Cell()
    load(tmp_path / "a.src").run(cell, until=lambda: cell.time > 0.45)
    assert cell.time == pytest.approx(0.5, abs=0.02)


def test_files_of_no_language_or_of_two_are_refused(tmp_path: Path) -> None:
    for name in ("a.txt", "a.mod", "b.script"):
        (tmp_path / name).touch()
    with pytest.raises(LanguageError, match=r"end with one of \.script"):
        load(tmp_path / "a.txt")
    with pytest.raises(LanguageError, match="have one language"):
        load(tmp_path / "a.mod", tmp_path / "b.script")
    with pytest.raises(LanguageError, match="there is no such file"):
        load(tmp_path / "missing.mod")


def test_frames_join_turn_and_come_back() -> None:
    frame = Frame.of_euler((1, 2, 3), 30, 20, 10)
    assert frame.euler() == pytest.approx((30, 20, 10))
    back = frame * frame.inverse()
    assert back.position == pytest.approx((0, 0, 0), abs=1e-12)
    assert back.rotation == pytest.approx((1, 0, 0, 0))
    assert Frame.of_vector((0, 0, 0), frame.vector()).rotation == pytest.approx(frame.rotation)
    assert frame.turn((1, 0, 0)) == pytest.approx(
        (Frame(rotation=frame.rotation) * Frame((1, 0, 0))).position
    )


def test_a_thread_without_an_end_ends_with_the_program(tmp_path: Path) -> None:
    text = "def prog():\n  thread idle():\n    while True:\n      sleep(0.1)\n    end\n  end\n"
    text += "  t = run idle()\n  sleep(0.3)\nend\n"
    for seed in range(4):
        assert run(tmp_path, "a.script", text, seed=seed)[1].seconds == pytest.approx(0.3, abs=0.02)


def test_a_whole_target_of_krl_reads_no_pose_and_one_with_parts_does(tmp_path: Path) -> None:
    reads: list[int] = []
    for target in ("X 500,Y 0,Z 400,A 0,B 180,C 0", "X 500,Z 400"):
        (tmp_path / "a.src").write_text(f"DEF a( )\nLIN {{{target}}}\nEND\n")
        cell, count = Cell(seed=1, noise=False), 0
        original = cell.arm.commanded_pose

        def counted(read: Callable[[], Any] = original) -> Any:
            nonlocal count
            count += 1
            return read()

        cell.arm.commanded_pose = counted  # type: ignore[method-assign]
        load(tmp_path / "a.src").run(cell)
        reads.append(count)
    assert reads == [0, 1]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        (
            "a.src",
            "DEF a(SPEED:IN )\nDECL REAL V\nV=SPEED*2\nEND\n",
            "a.src:3: speed has no value: a was called without it, or nothing set it (in a)",
        ),
        (
            "a.src",
            "DEF a( )\nWAIT SEC f( )\nEND\nDEFFCT REAL f( )\nENDFCT\n",
            "a.src:2: f ended without RETURN, and has no value (in a)",
        ),
        (
            "m.mod",
            "MODULE M\nPROC main()\nf;\nENDPROC\nPROC f(\\num x)\nWaitTime x;\nENDPROC\nENDMODULE",
            "m.mod:6: x has no value: f was called without it, or nothing set it (in f)",
        ),
        (
            "m.mod",
            "MODULE M\nPROC main()\nWaitTime f();\nENDPROC\nFUNC num f()\nENDFUNC\nENDMODULE",
            "m.mod:3: f ended without RETURN, and has no value (in main)",
        ),
        (
            "a.script",
            "def f():\n  a = 1\nend\nb = f()\nsleep(b)\n",
            "a.script:5: b has no value: <module> was called without it, or nothing set it (in <module>)",
        ),
        (
            "a.script",
            "def f():\n  a = 1\nend\nsleep(f())\n",
            "a.script:4: f has no value: it returns none (in <module>)",
        ),
        (
            "a.script",
            "def f():\n  return\nend\nb = 1 + f()\n",
            "a.script:4: f has no value: it returns none (in <module>)",
        ),
        (
            "a.script",
            "def f():\n  a = 1\nend\nif f():\n  sleep(1)\nend\n",
            "a.script:4: f has no value: it returns none (in <module>)",
        ),
        (
            "a.script",
            "movel(movej([0, 0, 0, 0, 0, 0]))\n",
            "a.script:1: movej has no value: it returns none (in <module>)",
        ),
        (
            "a.src",
            "DEF a( )\nWAIT SEC f( )\nEND\nDEF f( )\nEND\n",
            "a.src:2: f has no value: it returns none (in a)",
        ),
        (
            "m.mod",
            "MODULE M\nVAR num n;\nPROC main()\nn:=f()+1;\nENDPROC\nPROC f()\nENDPROC\nENDMODULE",
            "m.mod:4: f has no value: it returns none (in main)",
        ),
        (
            "a.src",
            "DEF a( )\n$VEL.CP=-0.2\nEND\n",
            "a.src:2: $VEL.CP cannot be -0.2: a speed is above 0 (in a)",
        ),
        (
            "a.src",
            "DEF a( )\nDECL INT I\nPTP I\nEND\n",
            "a.src:3: PTP I: expected a position {X …} or axes {A1 …}, found 0 (in a)",
        ),
        (
            "m.mod",
            "MODULE M\nPROC main()\nMoveAbsJ CRobT(),v100,fine,tool0;\nENDPROC\nENDMODULE",
            "m.mod:3: MoveAbsJ CRobT(),v100,fine,tool0: expected jointtarget, found robtarget (in main)",
        ),
    ],
)
def test_a_value_that_is_missing_or_of_another_kind_is_named(
    tmp_path: Path, name: str, text: str, message: str
) -> None:
    with pytest.raises(ProgramError, match=f"^{re.escape(message)}$"):
        run(tmp_path, name, text)


def test_the_mode_of_operation_of_krl_is_the_same_by_all_its_names(tmp_path: Path) -> None:
    condition = "$T1 AND ($MODE_OP==#T1) AND NOT ($T2 OR $AUT OR $EXT)"
    text = f"DEF a( )\nDECL INT N\nIF {condition} THEN\nN=1\nENDIF\nWAIT SEC N\nEND\n"
    assert run(tmp_path, "a.src", text)[1].seconds == pytest.approx(1.0)


def test_the_value_of_what_is_not_carried_out_is_not_known(tmp_path: Path) -> None:
    with pytest.raises(UnsupportedError, match=r"unsupported: the value of popup at line 1 of a\.script"):
        run(tmp_path, "a.script", 'sleep(popup("go on?"))\n')


def test_a_routine_of_krl_gives_back_elements_however_it_ends(tmp_path: Path) -> None:
    text = (
        "DEF a( )\nDECL INT N[2]\nf(N[1])\nWAIT SEC N[1]\nEND\nDEF f(X:OUT )\nDECL INT X\nX=2\nRETURN\nEND\n"
    )
    assert run(tmp_path, "a.src", text)[1].seconds == pytest.approx(2.0)


@pytest.mark.parametrize("begins", ["IF 1/n>0 THEN", "WHILE 1/n>2 DO", "FOR i FROM 1/n TO 0 DO", "TEST 1/n"])
def test_an_error_where_a_block_begins_goes_to_the_handler_of_its_routine(
    begins: str, tmp_path: Path
) -> None:
    ends = {"IF": "ENDIF", "WH": "ENDWHILE", "FO": "ENDFOR", "TE": "ENDTEST"}[begins[:2]]
    text = (
        f"MODULE M\nVAR num n;\nPROC main()\n{begins}\n{ends}\nWaitTime n;\n"
        "ERROR\nn:=n+1;\nRETRY;\nENDPROC\nENDMODULE"
    )
    assert run(tmp_path, "m.mod", text)[1].seconds == pytest.approx(1.0)


def test_an_error_that_a_handler_raises_in_a_block_goes_to_the_caller_s_once(tmp_path: Path) -> None:
    text = """MODULE M
VAR num n; VAR num handled;
PROC main()
  f;
  WaitTime handled;
ERROR
  n:=1;
  RETRY;
ENDPROC
PROC f()
  IF TRUE THEN
    handled:=handled+0/n;
  ENDIF
ERROR
  handled:=handled+1;
  RAISE;
ENDPROC
ENDMODULE
"""
    assert run(tmp_path, "m.mod", text)[1].seconds == pytest.approx(1.0)
