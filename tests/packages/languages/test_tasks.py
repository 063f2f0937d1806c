"""Several tasks of a RAPID controller take turns, and share signals and the PERS data that both declare."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mutabot_cell import Cell
from mutabot_languages import LanguageError, load

MAIN = """MODULE Robot
  PERS num order := 0;
  PERS num seen := 0;
  TASK PERS num own := 1;
  VAR num count := 0;
  PROC main()
    order := 7;
    WaitUntil seen = 7;
    count := count + 1;
    WaitDI diReady, 1;
    own := own + 1;
  ENDPROC
ENDMODULE
"""
OTHER = """MODULE Logic
  PERS num order := 3;
  PERS num seen := 0;
  TASK PERS num own := 5;
  VAR num count := 100;
  PROC main()
    WHILE TRUE DO
      IF order = 7 THEN
        seen := order;
        own := own + 1;
        count := count + 1;
        WaitTime 0.5;
        SetDO doReady, 1;
      ENDIF
      WaitTime 0.01;
    ENDWHILE
  ENDPROC
ENDMODULE
"""
SIGNALS = '[in.diReady]\noutput = "doReady"\n'


def run(folder: Path, other: str = OTHER, **options: Any) -> Any:
    (folder / "robot.mod").write_text(MAIN)
    (folder / "logic.mod").write_text(other)
    (folder / "cell_map.toml").write_text(SIGNALS)
    return load(folder / "robot.mod").run(Cell(seed=1), tasks=[load(folder / "logic.mod")], **options)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_task_waits_for_what_another_one_says(tmp_path: Path, seed: int) -> None:
    ended = run(tmp_path, seed=seed)
    assert ended.variables["seen"] == 7
    assert ended.variables["count"] == 1  # VAR data is each task's own
    assert ended.variables["own"] == 2  # and so is TASK PERS
    assert 0.49 < ended.seconds < 0.6
    assert ended.outputs["doready"] == 1


def test_an_interrupt_of_another_task_is_carried_out(tmp_path: Path) -> None:
    other = OTHER.replace(
        "    WHILE TRUE DO\n", "    CONNECT late WITH tell;\n    ITimer 0.2, late;\n    WHILE TRUE DO\n"
    ).replace("        SetDO doReady, 1;\n", "        seen := 7;\n")
    other = other.replace("  PROC main()", "  VAR intnum late;\n  PROC main()").replace(
        "ENDMODULE", "  TRAP tell\n    SetDO doReady, 1;\n  ENDTRAP\nENDMODULE"
    )
    assert run(tmp_path, other).seconds < 0.4


def test_tasks_are_programs_in_rapid(tmp_path: Path) -> None:
    (tmp_path / "a.script").write_text("sleep(1)\n")
    program = load(tmp_path / "a.script")
    with pytest.raises(LanguageError, match="tasks: only programs in RAPID have others beside them"):
        program.run(Cell(seed=1), tasks=[program])
