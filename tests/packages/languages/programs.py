"""The same small task in three languages, and the files of each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mutabot_cell import Cell
from mutabot_languages import load

URSCRIPT = """def pick():
  over = p[0.5, 0.2, 0.3, 0, 3.1415926, 0]
  movej(over, a=1.4, v=1.05)
  movel(pose_trans(over, p[0, 0, 0.1, 0, 0, 0]), v=0.25)
  set_standard_digital_out(0, True)
  sleep(0.5)
  if get_standard_digital_in(3) and 2 > 1:
    movel(over)
  end
end
"""
RAPID = """MODULE Pick
  CONST robtarget pOver:=[[500,200,300],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PERS tooldata tGrip:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,0.1],[1,0,0,0],0,0,0]];
  PERS wobjdata wTable:=[FALSE,TRUE,"",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  PROC main()
    ! Grüße
    MoveJ pOver, v500, z10, tGrip\\WObj:=wTable;
    MoveL Offs(pOver,0,0,-100), v200, fine, tGrip\\WObj:=wTable;
    SetDO grip, 1;
    WaitTime 0.5;
    WaitDI part, 1\\MaxTime:=2;
    IF TestDI(part) AND 2>1 THEN
      MoveL pOver, v200, fine, tGrip\\WObj:=wTable;
    ENDIF
  ENDPROC
ENDMODULE
"""
KRL = """&ACCESS RVP
DEF pick( )
;FOLD INI
BAS (#INITMOV,0 )
;ENDFOLD (INI)
PTP XP1 C_PTP
$VEL.CP=0.2
LIN XP1:{X 0,Y 0,Z 100,A 0,B 0,C 0}
$OUT[9]=TRUE
WAIT SEC 0.5
WAIT FOR $IN[25]==TRUE
IF $IN[25] AND (2>1) THEN
LIN XP1
ENDIF
END
"""
DATA = """DEFDAT PICK
DECL E6POS XP1={X 500,Y 200,Z 300,A 0,B 180,C 0,S 2,T 10,E1 0.0}
ENDDAT
"""
FILES = {
    "urscript": {"pick.script": URSCRIPT},
    "rapid": {"pick.mod": RAPID},
    "krl": {"pick.src": KRL.replace("\n", "\r\n"), "pick.dat": DATA},
}
INPUTS = {"standard_digital_in[3]": True, "part": 1, "$IN[25]": True}


def written(folder: Path, language: str) -> Path:
    """The first file of the program in a language, which is written to a folder."""
    for name, text in FILES[language].items():
        (folder / name).write_bytes(text.encode("latin-1"))
    return folder / next(iter(FILES[language]))


def run(folder: Path, name: str, text: str, **options: Any) -> tuple[Cell, Any]:
    """Run a program of one file; the cell, and what the run returns."""
    (folder / name).write_text(text, encoding="latin-1")
    cell = Cell(seed=1)
    return cell, load(folder / name).run(cell, **options)
