"""The operators of textbooks: what each makes of a program in each language, and that it still reads."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot_languages import load
from mutabot_languages.errors import ProgramError
from mutabot_languages.mutation.planning import PlannedText, planned_texts
from mutabot_languages.mutation.rules import BY_NAME, CONVENTIONAL
from tests.packages.languages.programs import FILES, INPUTS, run, written

#: programs that have a place for every one of the operators
RAPID = """MODULE M
  VAR num n:=2;
  VAR num m:=-3;
  VAR bool b;
  CONST robtarget p1:=[[500,-2,0],[0,0,1,0],[1,0,2,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  VAR robtarget p2;
  PERS tooldata t1:=[TRUE,[[0,0,3],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
  PROC main()
    n:=m+n*2;
    IF n>m AND NOT b THEN
      MoveL p1, v100, fine, t1;
      MoveL p2, v100, fine, t1;
    ENDIF
    Incr n;
    n:=BitAnd(n,3);
    n:=BitLSh(n,1);
    p2.trans.z:=Abs(n);
  ENDPROC
ENDMODULE
"""
KRL = """DEF a()
DECL INT I,J
DECL BOOL B
SIGNAL HOLD $IN[3]
I=J B_AND 3
J=-I*2
B=HOLD AND $IN[4]
IF (I==J) EXOR B THEN
  I=1
ENDIF
XP1={X 1,Y -2,Z 0,A 0,B 0,C 0,S 2,T 10}
END
"""
SCRIPT = """def f():
  x = 1.5
  y = x * 2
  home = [0, -1.57, 1.2, 0, 0, 0]
  pick = p[0.1, 0.2, 0, 0, 3.14, 0]
  place = p[0.4, 0.2, 0, 0, 3.14, 0]
  movel(pick, v=0.2)
  movel(place)
  while x < y and not get_standard_digital_in(1):
    x = x + 1
  end
end
"""
PROGRAMS = {"a.mod": RAPID, "a.src": KRL, "a.script": SCRIPT}
#: what the languages have nothing for
LACKING = {
    "a.mod": set(),
    "a.src": {"replace-shift", "replace-assignment"},
    "a.script": {"replace-shift", "replace-assignment", "replace-bitwise"},
}


def conventional(folder: Path, name: str, text: str) -> list[PlannedText]:
    (folder / name).write_text(text)
    found = planned_texts(folder, [name])
    return [planned for planned in found if BY_NAME[planned.difference.operator].family == CONVENTIONAL]


def described(found: list[PlannedText], operator: str) -> list[str]:
    return [planned.description for planned in found if planned.difference.operator == operator]


@pytest.mark.parametrize("name", PROGRAMS)
def test_each_operator_has_mutants_that_differ_in_a_line_and_read_clean(name: str, tmp_path: Path) -> None:
    found = conventional(tmp_path, name, PROGRAMS[name])
    operators = {rule.name for rule in BY_NAME.values() if rule.family == CONVENTIONAL}
    assert {planned.difference.operator for planned in found} == operators - LACKING[name]
    for planned in found:
        diff = planned.program.diff(planned.difference)
        assert [line[0] for line in diff[2:]] == ["@", "-", "+"], diff
        changed = planned.program.changed(planned.difference)
        assert planned.program.language.read("", changed).diagnostics == ()
    texts = [(planned.difference.operator, planned.difference.edits) for planned in found]
    assert len(texts) == len(set(texts))


@pytest.mark.parametrize(
    ("name", "operator", "changes"),
    [
        ("a.mod", "absolute-value", ["n → Abs(n)", "n → -Abs(n)", "n → (n/(n/n))"]),
        ("a.mod", "absolute-value", ["m → Abs(m)", "m → (-Abs(m))", "m → (m/(m/m))"]),
        ("a.mod", "replace-arithmetic", ["n*2 → n+2", "n*2 → n DIV 2", "n*2 → n", "n*2 → 2"]),
        ("a.mod", "replace-relation", ["n>m → n<=m", "n>m → n=m", "n>m → TRUE", "n>m → FALSE"]),
        ("a.mod", "replace-logic", ["n>m AND NOT b → n>m XOR NOT b", "n>m AND NOT b → n>m"]),
        ("a.mod", "replace-bitwise", ["BitAnd(n,3) → BitOr(n,3)", "BitAnd(n,3) → BitXOr(n,3)"]),
        ("a.mod", "replace-shift", ["BitLSh(n,1) → BitRSh(n,1)"]),
        ("a.mod", "replace-assignment", ["Incr n → Decr n"]),
        ("a.mod", "insert-unary", ["m → (-m)", "n>m → (NOT (n>m))", "500 → -500"]),
        ("a.mod", "delete-unary", ["-3 → 3", "-2 → 2", "NOT b → b"]),
        ("a.mod", "replace-variable", ["p1 → p2", "p2 → p1", "n → m"]),
        ("a.mod", "replace-statement", ["MoveL p1, v100, fine, t1 → WaitTime 1/0", "Incr n → WaitTime 1/0"]),
        ("a.src", "absolute-value", ["I → ABS(I)", "-I*2 → ABS(-I*2)"]),
        ("a.src", "replace-relation", ["I==J → I<J", "I==J → I<>J"]),
        ("a.src", "replace-logic", ["(I==J) EXOR B → (I==J) AND B", "(I==J) EXOR B → B"]),
        ("a.src", "replace-bitwise", ["J B_AND 3 → J B_OR 3", "J B_AND 3 → J B_EXOR 3", "J B_AND 3 → 3"]),
        ("a.src", "insert-unary", ["HOLD → (NOT (HOLD))", "$IN[4] → (NOT ($IN[4]))", "1 → -1"]),
        ("a.src", "delete-unary", ["-I → I", "-2 → 2"]),
        ("a.src", "replace-variable", ["HOLD → B", "J → I"]),
        ("a.src", "replace-statement", ["I=1 → WAIT SEC 1/0"]),
        ("a.script", "absolute-value", ["x → norm(x)", "x → (-norm(x))", "x + 1 → -norm(x + 1)"]),
        ("a.script", "replace-arithmetic", ["x + 1 → x % 1", "x + 1 → 1"]),
        ("a.script", "replace-relation", ["x < y → x != y", "x < y → False"]),
        ("a.script", "insert-unary", ["1.2 → -1.2", "0.4 → -0.4", "x < y → (not (x < y))"]),
        ("a.script", "delete-unary", ["-1.57 → 1.57"]),
        ("a.script", "replace-variable", ["pick → place", "place → pick", "y → x"]),
        ("a.script", "replace-statement", ["movel(place) → sleep(1/0)"]),
    ],
)
def test_what_operators_make_of_a_program(
    name: str, operator: str, changes: list[str], tmp_path: Path
) -> None:
    assert set(changes) <= set(described(conventional(tmp_path, name, PROGRAMS[name]), operator))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.mod", "MODULE M\nPROC main()\nSetDO doGrip,b;\nn:=x{2};\nENDPROC\nENDMODULE\n"),
        (
            "a.mod",
            "MODULE M\nPERS tooldata t:=[TRUE,[[0,0,3],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];\nENDMODULE\n",
        ),
        (
            "a.mod",
            "MODULE M\nVAR robtarget p:=[[0,0,0],[0,0,0,0],[1,0,2,0],[9E9,9E9,0,0,0,0]];\nENDMODULE\n",
        ),
        ("a.src", "DEF a()\nSIGNAL S $OUT[9]\nX={S 2,T 10}\n$OUT[3]=$IN[4]\nEND\n"),
        ("a.script", "set_standard_digital_out(1, get_tool_digital_in(1))\n"),
    ],
)
def test_a_number_that_says_which_gets_no_sign(name: str, text: str, tmp_path: Path) -> None:
    found = described(conventional(tmp_path, name, text), "insert-unary")
    assert not [change for change in found if "→ -" in change]


def test_a_variable_becomes_none_that_is_of_another_type_or_has_no_value_yet(tmp_path: Path) -> None:
    text = "def f(a):\n  x = 1\n  y = x + 2\n  z = p[0, 0, 0, 0, 0, 0]\n  w = y\n  movel(z)\nend\n"
    assert described(conventional(tmp_path, "a.script", text), "replace-variable") == ["y → x"]


def test_a_variable_becomes_at_most_four_others(tmp_path: Path) -> None:
    names = "abcdefg"
    text = "".join(f"{name} = 1\n" for name in names) + f"x = {' + '.join(names)}\n"
    found = described(conventional(tmp_path, "a.script", text), "replace-variable")
    assert [change for change in found if change.startswith("a → ")] == [f"a → {name}" for name in "bcde"]


@pytest.mark.parametrize("language", FILES)
def test_a_replaced_statement_stops_the_program_where_it_stands(language: str, tmp_path: Path) -> None:
    path = written(tmp_path, language)
    found = planned_texts(tmp_path, [path.name])
    chosen = [planned for planned in found if planned.difference.operator == "replace-statement"]
    assert len(chosen) > 4
    from mutabot_cell import Cell  # noqa: PLC0415  # loads the physics

    for planned in chosen[:: len(chosen) - 1]:
        path.write_bytes(planned.program.changed(planned.difference).encode(planned.program.encoding))
        with pytest.raises(ProgramError, match="division by zero"):
            load(path).run(Cell(seed=1), inputs=INPUTS)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.script", "x = {}\ny = norm(2 - x)\n"),
        ("a.src", "DEF a()\nDECL REAL X,Y\nX={}\nY=ABS(2-X)\nEND\n"),
        (
            "a.mod",
            "MODULE M\nVAR num x;\nVAR num y;\nPROC main()\nx:={};\ny:=Abs(2-x);\nENDPROC\nENDMODULE\n",
        ),
    ],
)
def test_a_value_that_must_not_be_zero_stays_what_it_is_and_else_fails(
    name: str, text: str, tmp_path: Path
) -> None:
    for value, is_zero in ((0.7, False), (2, True)):
        found = conventional(tmp_path, name, text.format(value))
        (planned,) = (
            planned
            for planned in found
            if (planned.difference.operator, planned.difference.variant) == ("absolute-value", "failOnZero")
            and planned.description.startswith("2")
        )
        changed = planned.program.changed(planned.difference)
        if is_zero:
            with pytest.raises(ProgramError, match="division by zero"):
                run(tmp_path, name, changed)
        else:
            run(tmp_path, name, changed)
