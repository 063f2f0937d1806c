"""What becomes of a pose that no joint angles reach: a motion is refused, a function says so."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot_cell import MotionRefused
from mutabot_languages import ProgramError
from tests.packages.languages.programs import run

RAPID = """MODULE M
  VAR jointtarget j;
  VAR errnum why;
  VAR num found;
  PROC main()
    ask Offs(CRobT(),0,0,5000);
  ENDPROC
  PROC ask(robtarget p)
    BODY
  ERROR
    IF ERRNO=ERR_OUTSIDE_REACH THEN
      found:=1;
    ELSEIF ERRNO=ERR_ROBLIMIT THEN
      found:=2;
    ENDIF
    TRYNEXT;
  ENDPROC
ENDMODULE
"""
FAR = "far = p[3, 0, 0.3, 0, 3.14, 0]\n"
HERE = "here = get_actual_tcp_pose()\n"


@pytest.mark.parametrize(
    ("name", "text", "place"),
    [
        ("a.script", f"{FAR}movel(far)\n", r"a.script:2: movel\(far\)"),
        ("a.script", f"{FAR}movej(far)\n", r"a.script:2: movej\(far\)"),
        ("a.script", f"{FAR}movej(far, t=2)\n", r"a.script:2: movej\(far, t=2\)"),
        ("m.mod", RAPID.replace("BODY", "MoveJ p,v100,fine,tool0;"), "m.mod:9: MoveJ p,v100,fine,tool0"),
        ("a.src", "DEF a( )\nPTP {X 3000,Y 0,Z 0,A 0,B 0,C 0}\nEND\n", "a.src:2: PTP {X 3000,Y 0,Z 0,A"),
    ],
)
def test_a_motion_out_of_reach_is_refused(tmp_path: Path, name: str, text: str, place: str) -> None:
    with pytest.raises(MotionRefused, match=rf"^{place}.*: out of reach from .* \(in "):
        run(tmp_path, name, text)


def test_a_script_that_computes_joint_angles_for_a_pose_out_of_reach_stops(tmp_path: Path) -> None:
    with pytest.raises(
        ProgramError, match=r"^a.script:2: q = get_inverse_kin\(far\): unreachable: no joint an"
    ):
        run(tmp_path, "a.script", f"{FAR}q = get_inverse_kin(far)\n")


def test_a_script_can_ask_whether_a_pose_is_in_reach(tmp_path: Path) -> None:
    asks = "a = get_inverse_kin_has_solution(far)\nb = get_inverse_kin_has_solution(here)\n"
    _, ended = run(tmp_path, "a.script", FAR + HERE + asks)
    assert (ended.variables["a"], ended.variables["b"]) == (False, True)


def test_the_error_handler_of_rapid_gets_the_error_of_a_function(tmp_path: Path) -> None:
    _, ended = run(tmp_path, "m.mod", RAPID.replace("BODY", "j:=CalcJointT(p,tool0);"))
    assert ended.variables["found"] == 1


def test_joint_limits_are_another_error_than_the_reach(tmp_path: Path) -> None:
    folded = RAPID.replace("Offs(CRobT(),0,0,5000)", "Offs(CRobT(),-200,0,0)")
    _, ended = run(tmp_path, "m.mod", folded.replace("BODY", "j:=CalcJointT(p,tool0);"))
    assert ended.variables["found"] == 2


@pytest.mark.parametrize(("far", "found"), [("5000", True), ("-20", False)])
def test_rapid_can_have_the_error_in_a_variable(tmp_path: Path, far: str, found: bool) -> None:
    asks = "j:=CalcJointT(p,tool0\\ErrorNumber:=why);\nIF why<>0 THEN\nfound:=3;\nENDIF"
    _, ended = run(tmp_path, "m.mod", RAPID.replace("BODY", asks).replace("5000", far))
    assert ended.variables["found"] == (3 if found else 0)


def krl(folder: Path, asks: str) -> Any:
    """The variables of the data file after some statements."""
    (folder / "a.dat").write_text("DEFDAT A\nDECL INT SAID=9\nDECL REAL A1=0.0\nENDDAT\n")
    declared = "DECL INT E\nDECL E6AXIS Q\nDECL E6POS P"
    _, ended = run(folder, "a.src", f"DEF a( )\n{declared}\n{asks}\nSAID=E\nEND\n")
    return ended.variables


def test_krl_says_in_the_last_argument_whether_there_are_axes(tmp_path: Path) -> None:
    near = krl(tmp_path, "P=$POS_ACT\nE=7\nQ=INVERSE(P,$AXIS_ACT,E)\nA1=Q.A1-$AXIS_ACT.A1")
    assert near["said"] == 0
    assert abs(near["a1"]) < 0.01
    far = krl(tmp_path, "P=$POS_ACT\nP.X=5000\nQ=INVERSE(P,$AXIS_ACT,E)")
    assert far["said"] != 0
    assert krl(tmp_path, "E=7\nP=FORWARD($AXIS_ACT,E)")["said"] == 0


def test_krl_without_that_argument_stops(tmp_path: Path) -> None:
    with pytest.raises(ProgramError, match=r"^a.src:7: Q=INVERSE\(P\): unreachable: no joint angles"):
        krl(tmp_path, "P=$POS_ACT\nP.X=5000\nQ=INVERSE(P)")
