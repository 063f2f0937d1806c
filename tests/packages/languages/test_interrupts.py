"""Interrupts of RAPID and KRL, and triggers along a motion, as they run on the cell."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot_cell import Cell
from mutabot_languages import ProgramError, UnsupportedError, load

_DATA = """VAR intnum i;
  VAR num n:=0;
  VAR num seen:=0;
  VAR robtarget p;
  VAR triggdata t;
  TRAP count
    n:=n+1;
  ENDTRAP
"""


def ran(folder: Path, name: str, text: str, inputs: dict[str, Any] | None = None) -> tuple[Cell, Any]:
    (folder / name).write_text(text, encoding="latin-1")
    cell = Cell(seed=1, noise=False)
    given = {
        key: (lambda function=value: function(cell)) if callable(value) else value
        for key, value in (inputs or {}).items()
    }
    return cell, load(folder / name).run(cell, inputs=given)


def rapid(folder: Path, body: str, inputs: dict[str, Any] | None = None) -> Any:
    text = f"MODULE M\n{_DATA}PROC main()\nCONNECT i WITH count;\n{body}\nENDPROC\nENDMODULE\n"
    return ran(folder, "m.mod", text, inputs)[1].variables


def pulses(cell: Cell) -> int:
    """1 in every second tenth of a second, for half a second."""
    return int(cell.time < 0.5 and int(cell.time * 10 + 0.001) % 2 == 1)


@pytest.mark.parametrize(
    ("body", "count"),
    [
        ("ISignalDI di, 1, i;\nWaitTime 1;", 2),
        ("ISignalDI di, 2, i;\nWaitTime 1;", 4),
        ("ISignalDI \\Single, di, 1, i;\nWaitTime 1;", 1),
        ("ISignalDI di, 1, i;\nISleep i;\nWaitTime 0.25;\nIWatch i;\nWaitTime 1;", 1),
        ("ISignalDI di, 1, i;\nIDelete i;\nWaitTime 1;", 0),
        ("ISignalDI di, 1, i;\nIDisable;\nWaitTime 0.25;\nseen:=n;\nIEnable;\nWaitTime 1;", 2),
        ("ITimer 0.2, i;\nWaitTime 1.05;", 5),
        ("ITimer \\Single, 0.2, i;\nWaitTime 1;", 1),
    ],
)
def test_a_trap_runs_as_often_as_its_interrupt_happens(tmp_path: Path, body: str, count: int) -> None:
    ended = rapid(tmp_path, body, {"di": pulses})
    assert ended["n"] == count
    assert ended["seen"] == 0


def test_what_holds_when_an_interrupt_is_ordered_is_no_change(tmp_path: Path) -> None:
    assert rapid(tmp_path, "ISignalDI di, 1, i;\nWaitTime 0.5;", {"di": 1})["n"] == 0


def test_a_trap_runs_while_a_motion_goes_on_and_the_program_begins_nothing(tmp_path: Path) -> None:
    text = """MODULE M
      VAR intnum i;
      VAR num went:=0;
      VAR num after:=0;
      VAR num inside:=0;
      VAR robtarget p;
      TRAP hold
        p:=CRobT();
        WaitTime 3;
        went:=Distance(p.trans,CPos());
        inside:=after;
      ENDTRAP
      PROC main()
        VAR robtarget q;
        CONNECT i WITH hold;
        ITimer \\Single, 0.1, i;
        q:=CRobT();
        MoveL Offs(q,0,0,60), v100, fine, tool0;
        after:=1;
      ENDPROC
    ENDMODULE
    """.replace("\\\\", "\\")
    _, ended = ran(tmp_path, "m.mod", text)
    assert ended.variables["went"] > 30
    assert ended.variables["inside"] == 0
    assert ended.variables["after"] == 1


@pytest.mark.parametrize(
    ("body", "error", "text"),
    [
        ("CONNECT i WITH count;", ProgramError, "connected already"),
        ("IDelete i;\nITimer 1, i;", ProgramError, "connected to no trap"),
        ("IWatch i;", ProgramError, "is not ordered"),
        ("CONNECT k WITH count;", ProgramError, "there is no interrupt k"),
        ("ISignalGI gi, i;", UnsupportedError, "unsupported: isignalgi at line"),
        ("TriggInt t, 5, i;", UnsupportedError, "unsupported: triggint at line"),
    ],
)
def test_wrong_interrupts_are_errors(tmp_path: Path, body: str, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        rapid(tmp_path, body)


def test_a_motion_that_a_trap_stops_is_said_to_be_unsupported(tmp_path: Path) -> None:
    text = f"MODULE M\n{_DATA.replace('n:=n+1', 'StopMove')}PROC main()\nCONNECT i WITH count;\n"
    text += "ITimer 0.1, i;\nWaitTime 1;\nENDPROC\nENDMODULE\n"
    with pytest.raises(UnsupportedError, match=r"unsupported: stopmove in a trap at line 8 of m\.mod"):
        ran(tmp_path, "m.mod", text)


@pytest.mark.parametrize(("option", "height"), [("", 0.04), ("\\Start", 0.02)])
def test_a_trigger_sets_its_output_where_it_says(tmp_path: Path, option: str, height: float) -> None:
    """60 mm up; 20 mm from the end, or from the start."""
    (tmp_path / "cell_map.toml").write_text("[out.d]\ngripper = [0, 1]\n")
    text = (
        f"MODULE M\n{_DATA}PROC main()\np:=CRobT();\nTriggIO t, 20{option}\\DOp:=d, 1;\n"
        "TriggL Offs(p,0,0,60), v50, t, fine, tool0;\nENDPROC\nENDMODULE\n"
    )
    (tmp_path / "m.mod").write_text(text)
    cell = Cell(seed=1, noise=False)
    before = cell.truth.tool_pose().z
    heights: list[float] = []
    command = cell.gripper.command

    def noted(*given: Any, **named: Any) -> Any:
        heights.append(cell.truth.tool_pose().z - before)
        return command(*given, **named)

    cell.gripper.command = noted  # type: ignore[method-assign]
    load(tmp_path / "m.mod").run(cell)
    assert heights == [pytest.approx(height, abs=0.004)]


def test_an_interrupt_of_krl_calls_its_routine_when_its_condition_becomes_true(tmp_path: Path) -> None:
    text = """DEF a( )
DECL INT n
n=0
INTERRUPT DECL 5 WHEN $IN[1]==TRUE DO count(n)
INTERRUPT ON 5
WAIT SEC 0.25
INTERRUPT OFF 5
WAIT SEC 1
total=n
END
DEF count(m:OUT)
m=m+1
END
"""
    (tmp_path / "a.dat").write_text("DEFDAT a\nDECL INT total=9\nENDDAT\n")
    _, ended = ran(tmp_path, "a.src", text, {"$IN[1]": lambda cell: bool(pulses(cell))})
    assert ended.variables["total"] == 1


def test_a_motion_that_an_interrupt_of_krl_brakes_is_said_to_be_unsupported(tmp_path: Path) -> None:
    text = "DEF a( )\nINTERRUPT DECL 5 WHEN $IN[1] DO halt_it( )\nINTERRUPT ON 5\nWAIT SEC 1\nEND\n"
    with pytest.raises(UnsupportedError, match=r"unsupported: BRAKE at line 7 of a\.src"):
        ran(
            tmp_path,
            "a.src",
            f"{text}DEF halt_it( )\nBRAKE\nEND\n",
            {"$IN[1]": lambda cell: bool(pulses(cell))},
        )
