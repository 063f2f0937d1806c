"""Why a survivor survived, in one line."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from mutabot.model import By, Compared, Kind, Outcome, Path, Quantity, Verdict
from mutabot.model.world_difference import Apart, Diverged
from mutabot.results.divergence import change_text, explain, quantity_of
from mutabot.results.results import MutantResult
from tests.results.samples import BACK, NEGATE, REVERSE, SKIP, VOCABULARY, mutant

READ = Outcome(
    NEGATE.id,
    0,
    Verdict.SURVIVED,
    example=(0.0014, -0.0014),
    indistinguishable=True,
    distance=0.0,
    compared=Compared(calls=3, moments=1, returned=2),
)
FAR = Outcome(
    SKIP.id, 1, Verdict.SURVIVED, indistinguishable=False, distance=312.0, divergence=("box.x: 1", "b")
)


def test_a_reading_is_shown_with_its_unit_and_what_became_of_the_world() -> None:
    assert explain(NEGATE, [READ], VOCABULARY) == (
        "read -0.0014 m instead of 0.0014 m; "
        "nothing differs in 3 calls, probes at 1 moment, 2 returned values (indistinguishable)"
    )


def test_what_was_not_compared_at_all_is_not_listed() -> None:
    found = explain(REVERSE, [replace(READ, compared=Compared(calls=26), example=None)], VOCABULARY)
    assert found.endswith("nothing differs in 26 calls (indistinguishable)")
    assert Compared().text == "0 calls"


def test_a_command_is_sent_rather_than_read() -> None:
    end = replace(READ, example=(0.2, -0.2))
    assert explain(REVERSE, [end], VOCABULARY).startswith("sent -0.2 m instead of 0.2 m")


@pytest.mark.parametrize(("path", "verb"), [("pose", "sent"), (".pose", "read")])
def test_what_may_be_sent_or_read_is_decided_by_where_it_stands(path: str, verb: str) -> None:
    at = Path.parse(path, rooted=not path.startswith("."))
    turn = Quantity("pose", at, Kind.EULER, unit="rad", order="XYZ")
    end = replace(READ, example=([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]))
    assert (change_text(replace(REVERSE, quantity="pose"), end, turn) or "").startswith(verb)


def test_without_the_vocabulary_values_stand_without_unit() -> None:
    assert explain(NEGATE, [READ]).startswith("had -0.0014 instead of 0.0014")


def test_the_survivor_farthest_from_the_original_is_reported() -> None:
    near = replace(FAR, round=0, distance=2.0, divergence=("near",))
    assert explain(SKIP, [near, FAR], VOCABULARY) == "gripper.command: do nothing; box.x: 1"
    assert MutantResult(SKIP, (near, FAR), None, "").deviation == 312.0


@pytest.mark.parametrize(
    ("end", "line"),
    [
        (Outcome("m", 0, Verdict.NOT_COVERED), "no test reaches it"),
        (Outcome("m", 0, Verdict.KILLED, By.CHECK, message="far\nassert"), "killed by check: far"),
        (Outcome("m", 0, Verdict.KILLED, By.EXCEPTION), "killed by exception: no message"),
        (Outcome("m", 0, Verdict.REFUSED, message="too far"), "refused: too far"),
        (Outcome("m", 0, Verdict.ERROR, message="NaN"), "error: NaN"),
        (Outcome("m", 0, Verdict.NO_EFFECT), "it changed no value"),
        (Outcome("m", 0, Verdict.SURVIVED, distance=0.4), "every probe ended within its tolerance"),
        (Outcome("m", 0, Verdict.SURVIVED), "it is unknown how the world ended"),
    ],
)
def test_every_other_end_has_its_line(end: Outcome, line: str) -> None:
    assert line in explain(SKIP, [end])


def test_a_mutant_that_was_not_run_says_so() -> None:
    assert explain(SKIP, []) == "not run"


def test_a_round_that_no_test_reaches_outweighs_errors() -> None:
    ends = [
        Outcome("m", 0, Verdict.ERROR),
        Outcome("m", 1, Verdict.ERROR),
        Outcome("m", 2, Verdict.NOT_COVERED),
    ]
    assert explain(SKIP, ends) == "no test reaches it"


def test_a_survivor_is_indistinguishable_only_if_it_always_is() -> None:
    killed = Outcome("m", 0, Verdict.KILLED)
    for outcomes, is_so in (((READ,), True), ((READ, FAR), False), ((killed,), False)):
        assert MutantResult(SKIP, outcomes, None, "").indistinguishable is is_so


def test_the_quantity_of_a_mutant_comes_from_the_vocabulary() -> None:
    found = quantity_of(NEGATE, VOCABULARY)
    assert found is not None
    assert (found.kind, found.unit) == ("position", "m")
    assert quantity_of(SKIP, VOCABULARY) is None
    assert quantity_of(mutant(9, "reverse", BACK, "dq", ""), VOCABULARY) is None
    assert quantity_of(NEGATE, None) is None


def test_a_change_in_the_last_digits_is_printed_with_these() -> None:
    outcome = Outcome("m", 0, Verdict.SURVIVED, example=(-0.32741041, -0.32741042), gaps=("look",))
    assert explain(NEGATE, [outcome]) == (
        "had -0.32741042 instead of -0.32741041; not compared with the original: look"
    )


def test_the_change_is_that_of_the_test_whose_story_is_shown() -> None:
    def in_test(name: str, value: float, **details: Any) -> Diverged:
        return Diverged(name, 1.0, "", "box ended 0.3 m off", example=(0.5, value), **details)

    lost = in_test("lost", 0.7, scatters="box by 0.5 m")
    outcome = replace(FAR, example=(0.5, 0.9), diverged=(lost, in_test("told", 0.6)))
    assert change_text(NEGATE, outcome) == "had 0.6 instead of 0.5"
    assert MutantResult(NEGATE, (outcome,), None, "").change == "had 0.6 instead of 0.5"
    assert "had 0.6 instead of 0.5" in explain(NEGATE, [outcome])
    assert change_text(NEGATE, replace(outcome, diverged=())) == "had 0.9 instead of 0.5"


def test_a_survivor_is_reported_in_the_round_that_differs_in_a_stable_test() -> None:
    apart = (Apart("box", "m", 1.0, 9.0, 1.0, 9.0, 9.0, 0.001),)
    lost = Diverged("lost", 1.0, "", "box ended 9 m off", apart, scatters="box by 0.5 m")
    near = Diverged("near", 1.0, "", "box ended 2 mm off", (replace(apart[0], final=0.002, aside=0.0),))
    rounds = (replace(FAR, round=0, diverged=(lost,)), replace(FAR, round=1, diverged=(near,)))
    assert explain(NEGATE, rounds).endswith("box ended 2 mm off")
