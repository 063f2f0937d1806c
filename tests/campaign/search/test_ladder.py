"""The search finds the bracket of the whole ladder in fewer runs, and looks for what it cannot see."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mutabot.thresholds.brackets import MagnitudeResult, bracket_of
from mutabot.thresholds.search import LadderSearch

SIZE = 7
#: the first step that is noticed in a round; SIZE if none is
thresholds = st.lists(st.integers(0, SIZE), min_size=1, max_size=6)


def truth(threshold: int, refused_from: int = SIZE) -> dict[int, MagnitudeResult]:
    """What each step of a monotone round shows."""
    return {
        step: MagnitudeResult.REFUSED
        if step >= refused_from
        else MagnitudeResult.NOTICED
        if step >= threshold
        else MagnitudeResult.MISSED
        for step in range(SIZE)
    }


def run(rows: list[dict[int, MagnitudeResult]], **details: object) -> LadderSearch:
    """A search to its end, as the campaign drives it: the first round, then the others."""
    search = LadderSearch(SIZE, len(rows), **details)  # type: ignore[arg-type]
    for rounds in (range(1), range(1, len(rows))):
        for _ in range(1000):
            due = [(end, step) for end in range(max(rounds, default=-1) + 1) for step in search.due(end)]
            if not due:
                break
            for round, step in due:
                assert step not in search.found.get(round, {})
                search.take(round, step, rows[round][step])
        else:
            raise AssertionError("the search does not end")
    return search


def floats(row: dict[int, MagnitudeResult]) -> dict[float, MagnitudeResult]:
    return {float(step): value for step, value in row.items()}


@given(thresholds)
def test_a_monotone_round_has_the_bracket_of_its_whole_ladder(found: list[int]) -> None:
    rows = [truth(threshold) for threshold in found]
    search = run(rows)
    for round, row in enumerate(rows):
        assert bracket_of(floats(search.found[round])) == bracket_of(floats(row))


@given(thresholds, st.integers(1, SIZE))
def test_a_refusal_bounds_the_search_and_is_no_detection(found: list[int], refused: int) -> None:
    rows = [truth(threshold, refused) for threshold in found]
    search = run(rows)
    for round, row in enumerate(rows):
        ours, whole = bracket_of(floats(search.found[round])), bracket_of(floats(row))
        assert (ours.low, ours.high) == (whole.low, whole.high)
        assert (ours.refused is None) == (whole.refused is None)


@given(st.integers(0, SIZE))
def test_rounds_alike_take_about_half_of_the_ladder(threshold: int) -> None:
    search = run([truth(threshold)] * 5)
    assert sum(map(len, search.found.values())) <= 0.55 * 5 * SIZE


def test_rounds_alike_see_every_magnitude_in_some_round() -> None:
    for threshold in range(SIZE + 1):
        search = run([truth(threshold)] * 5)
        assert {step for row in search.found.values() for step in row} == set(range(SIZE))


def test_at_the_first_violation_the_whole_ladder_is_run_in_all_rounds() -> None:
    row = {**truth(2), SIZE - 1: MagnitudeResult.MISSED}
    search = run([row] * 3)
    assert search.is_violated
    assert all(len(found) == SIZE for found in search.found.values())


@given(
    st.lists(st.lists(st.sampled_from(MagnitudeResult), min_size=SIZE, max_size=SIZE), min_size=1, max_size=4)
)
def test_whatever_is_seen_the_search_ends(rows: list[list[MagnitudeResult]]) -> None:
    run([dict(enumerate(row)) for row in rows])


@given(thresholds, st.integers(0, SIZE - 1))
def test_a_demanded_magnitude_is_run_in_every_round(found: list[int], demanded: int) -> None:
    search = run([truth(threshold) for threshold in found], always=frozenset({demanded}))
    assert all(demanded in row for row in search.found.values())


def test_equal_seeds_choose_equal_guards() -> None:
    rows = [truth(3)] * 4
    assert run(rows, seed=5).found == run(rows, seed=5).found
