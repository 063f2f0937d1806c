"""What is said of disturbances, from how each magnitude ended."""

from __future__ import annotations

from mutabot_world.command import sections
from mutabot_world.ladders import JudgedOutcome, WorldEnd, WorldLadder, combined_ladders

SIGNS = {"N": WorldEnd.NOTICED, "U": WorldEnd.UNSEEN, "L": WorldEnd.LIVED, "P": WorldEnd.PASSED}


def ladder(*rounds: str, test: str = "tests/test_a.py::test_it") -> WorldLadder:
    """A ladder of 1, 2, 3 … kg, one letter per magnitude in each round; a blank was not run."""
    made = WorldLadder("payload", "+", "kg", (test,))
    for size in range(1, len(rounds[0]) + 1):
        made.texts[size] = f"a payload that is {size} kg heavier"
        made.numbers[size, test] = size
        found = made.found.setdefault(float(size), {})
        for number, ends in enumerate(rounds):
            if ends[size - 1] != " ":
                found[number] = {test: JudgedOutcome(SIGNS[ends[size - 1]])}
    return made


def test_the_sentence_names_the_least_that_every_round_notices_and_the_most_that_one_misses() -> None:
    assert ladder("LUNN", "LLUN").sentence == (
        "your tests notice a payload that is 4 kg heavier, not one of 3 kg"
    )
    assert (
        ladder("NN").sentence == "your tests notice a payload that is 1 kg heavier, the least that was tried"
    )


def test_a_larger_disturbance_that_is_missed_counts_although_smaller_ones_are_noticed() -> None:
    assert ladder("LNUN").noticed_from == 4
    assert ladder("LNU").sentence == (
        "your tests do not notice a payload that is 3 kg heavier, the most that was tried, though they "
        "notice 2 kg"
    )


def test_what_is_noticed_and_up_to_where_the_task_is_done_are_two_numbers() -> None:
    rungs = ladder("LLUN")
    assert (rungs.robust_to, rungs.unseen, rungs.noticed_from) == (2, [3], 4)
    assert ladder("ULN").robust_to is None


def test_nothing_is_claimed_of_an_end_that_nothing_shows() -> None:
    rungs = ladder("PPN")
    assert (rungs.robust, rungs.unseen, rungs.bar) == ("not known", [], "??█")
    assert ladder("UUN").robust == "not even the least"


def test_a_suite_notices_what_any_test_notices() -> None:
    (whole,) = combined_ladders([ladder("LUNU"), ladder("LLLN", test="tests/test_a.py::test_other")])
    assert [str(end) for end in whole.ends.values()] == [
        "lived with", "suffered unseen", "noticed", "noticed",
    ]  # fmt: skip


def test_a_campaign_that_has_not_run_all_says_so() -> None:
    told = dict(sections([ladder("  "), ladder("LN", test="tests/test_a.py::test_other")]))
    assert "Your tests notice" in told["In sentences"][0]
    assert dict(sections([ladder("  ")]))["Nothing is known of"] == ["payload +: not run"]
