"""Ids of mutants, what the baseline changes about them, and where there is none."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutabot.model import Sighting
from mutabot.model.activation import Activation
from mutabot.original import Original
from mutabot_source.extension import OF_TEXT
from mutabot_source.refine import plan_mutants, refine
from mutabot_source.registry import load_all, names
from mutabot_source.texts import find_texts
from tests.packages.source.build import choices, seen_in, text_of

SOURCE = """
HOME = (0.5, -0.2)

def run(arm):
    def lift(z=0.1):
        arm.move(z * 2)
    for _ in range(2):
        arm.move(HOME[0] + 1)
        arm.move(HOME[0] + 1)
    return [arm.x > i for i in HOME]

class Cell:
    def open(self):
        return self.width + 1
"""


def ids(tmp_path: Path, source: str, *operators: str) -> list[str]:
    (tmp_path / "mission.py").write_text(source, encoding="utf-8")
    return [planted.mutant.id for planted in plan_mutants(find_texts(tmp_path, ["mission.py"], operators))]


def test_ids_name_file_function_text_occurrence_operator_and_variant(tmp_path: Path) -> None:
    found = ids(tmp_path, SOURCE, "AOR")
    assert "mission.py:run.<locals>.lift:z * 2#1:AOR=add" in found
    assert "mission.py:run:HOME[0] + 1#2:AOR=leftOp" in found
    assert "mission.py:Cell.open:self.width + 1#1:AOR=pow" in found


def test_ids_are_unique_and_stable_under_edits_elsewhere(tmp_path: Path) -> None:
    before = ids(tmp_path, SOURCE, *names())
    assert len(set(before)) == len(before)
    after = ids(tmp_path, "import math\nx = 1\n\n" + SOURCE, *names())
    assert set(before) <= set(after)


def test_mutants_know_what_turns_them_on(tmp_path: Path) -> None:
    text = text_of(tmp_path, SOURCE)
    planted = plan_mutants([text])
    assert [planned_mutant.active.data for planned_mutant in planted if planned_mutant.active] == [
        choice for choice, _, _ in choices(text)
    ]
    assert planted[0].active == Activation.of_text(1, 0)


def test_taught_points_and_defaults_are_evaluated_at_import(tmp_path: Path) -> None:
    text = text_of(tmp_path, SOURCE)
    at_import = {place.text for place in text.places if place.at_import and not place.statement}
    assert {"0.5", "-0.2"} <= at_import
    assert not {"0.1", "z * 2", "HOME"} & at_import
    assert next(place for place in text.places if place.text == "0.1").span.function == "run"


@pytest.mark.parametrize(
    "source",
    [
        "def f(x: 1 + 1 = None) -> -1: ...",
        "x: 2 + 2",
        "match 'x':\n    case -1 | 2: pass",
        "if TYPE_CHECKING:\n    x = 1 + 1",
        "if __name__ == '__main__':\n    x = 1 + 1",
        "'a' + 'b'",
        '"""text"""',
    ],
)
def test_what_is_not_evaluated_by_a_test_has_no_mutants(tmp_path: Path, source: str) -> None:
    operators = [name for name in names() if name != "BSR"]
    assert text_of(tmp_path, source, *operators).places == ()


def test_columns_count_bytes_as_the_interpreter_does(tmp_path: Path) -> None:
    text = text_of(tmp_path, "größe = 'ü'; y = größe * 2\n", "AOR")
    assert text.places[0].extent == (1, 20, 1, 31)


def test_equal_expressions_in_one_old_f_string_are_left_alone(tmp_path: Path) -> None:
    text = text_of(tmp_path, "y = f'{x + 1} {x + 1}'\n", "AOR")
    assert len({place.extent for place in text.places}) == len(text.places)


def test_after_the_baseline_only_fitting_types_are_left(tmp_path: Path) -> None:
    text = text_of(tmp_path, "y = a + b\nz = c\n", "AOR", "ABS", "SVR")
    by_text = {place.text: place.number for place in text.places}
    first = [
        Sighting(by_text["a + b"], 1, ("text",)),
        Sighting(by_text["a"], 1, ("text",), ("b", "n")),
        Sighting(by_text["c"], 1),
    ]
    second = [Sighting(by_text["a"], 2, ("text",), ("b",)), Sighting(by_text["b"], 1, ("integer",))]
    (refined,), left_out = refine([text], seen_in(first, second))
    assert [(alternative.operator, alternative.text) for _, _, alternative in choices(refined)] == [
        ("SVR", "b"),
        ("ABS", "abs(b)"),
        ("ABS", "-abs(b)"),
        ("ABS", "failOnZero(b)"),
    ]
    reasons = {(item.mutant.site.text, item.reason) for item in left_out}
    assert ("a + b", "its value is text, never number") in reasons
    assert ("c", "the type of its value was not seen") in reasons
    assert left_out[0].as_left_out.id.endswith("a + b#1:ABS=abs")


def test_where_no_test_comes_all_is_planted_that_may_fit(tmp_path: Path) -> None:
    text = text_of(tmp_path, "def f(a, b):\n    return a + b\n", "AOR", "SVR")
    (refined,), left_out = refine([text], Original())
    assert {alternative.text for _, _, alternative in choices(refined) if alternative.operator == "SVR"} == {
        "a",
        "b",
    }
    assert "a - b" in {alternative.text for _, _, alternative in choices(refined)}
    assert left_out == []


def test_an_unknown_operator_is_refused_with_those_that_there_are(tmp_path: Path) -> None:
    with pytest.raises(LookupError, match="no operator 'AORR' on program text; there are ABS, AOR"):
        text_of(tmp_path, "x = 1", "AORR")


def test_each_operator_has_a_name_of_its_own_and_a_family_of_the_provider() -> None:
    assert len(set(names())) == len(names())
    assert {rule.family for rule in load_all()} == set(OF_TEXT)
