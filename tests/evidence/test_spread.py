"""Deviation in units of the original's own spread: which things and tests a story is told by."""

from __future__ import annotations

from math import cos, radians, sin

import pytest

from mutabot.evidence import recorder as recorders
from mutabot.evidence.feed import Feed
from mutabot.evidence.paths import RecordedPaths, turned_aside
from mutabot.evidence.recording import RecordedCall, Recording
from mutabot.evidence.spread import spread_between
from mutabot.evidence.story import diverged
from mutabot.model import Outcome, Verdict
from mutabot.model.deviation import deviation_of, difference_of, spread_of
from mutabot.model.world_difference import Diverged
from tests.evidence.worlds import SHELF, TABLE, Place, line, recorded

WAY = [SHELF, *line(SHELF, TABLE, 2.0)]


def ending(end: Place, start: Place = SHELF) -> Recording:
    """A tool that always goes the same way, and a box that ends somewhere."""
    return recorded(WAY, [start, *line(start, end, 2.0)])


def beside(x: float) -> Recording:
    return ending((1.0 + x, 0.0, 0.025))


def told(mutant: Recording, *runs: Recording) -> Diverged:
    found = diverged(
        "test",
        RecordedPaths(runs[0]),
        RecordedPaths(mutant),
        spread=spread_between([RecordedPaths(run) for run in runs]),
    )
    assert found is not None
    return found


def box_of(found: Diverged) -> float:
    (box,) = (deviation.deviation for deviation in found.apart if deviation.name == "box")
    return box


def test_a_deviation_is_the_difference_in_units_of_the_originals_spread() -> None:
    assert box_of(told(beside(0.3), beside(0.0), beside(0.06))) == pytest.approx(5.0, rel=0.01)


def test_where_the_original_does_not_spread_the_tolerance_is_the_unit() -> None:
    assert box_of(told(beside(0.3), beside(0.0), beside(0.0))) == pytest.approx(300.0, rel=0.01)


def test_what_differs_by_no_more_than_the_original_itself_is_not_reported() -> None:
    found = told(beside(0.05), beside(0.0), beside(0.08))
    assert box_of(found) <= 1.0
    assert "box" not in found.story


def test_what_each_seed_places_elsewhere_and_nothing_moves_has_a_stable_end() -> None:
    places = [(0.0, 0.0, 0.5), (0.3, 0.0, 0.5), (0.0, 0.4, 0.5)]
    still = [RecordedPaths(ending(place, place)) for place in places]
    assert spread_between(still).ends["box"] == pytest.approx(0.0, abs=1e-6)
    assert not spread_between(still).scatters


def test_a_test_in_which_the_original_scatters_says_so() -> None:
    found = told(beside(2.0), beside(0.0), beside(0.52))
    assert found.scatters == "box by 0.52 m"
    assert found.story.startswith("only in a test whose end the original itself scatters (box by 0.52 m): ")


def test_the_story_is_shown_in_a_test_whose_end_is_stable() -> None:
    lost = told(beside(9.0), beside(0.0), beside(0.5))
    stable = told(beside(0.02), beside(0.0), beside(0.001))
    assert lost.apart[0].final > stable.apart[0].final
    for both in ((lost, stable), (stable, lost)):
        outcome = Outcome("m", 0, Verdict.SURVIVED, diverged=both)
        assert outcome.shown_difference is stable
        assert outcome.deviation == stable.deviation


def test_a_contact_that_the_original_has_with_another_seed_is_no_news() -> None:
    def touched(*pairs: tuple[str, str], lower: float = 0.0) -> Recording:
        way = [(x, y, z - lower) for x, y, z in WAY]
        return recorded(way, WAY, lambda now: {*pairs} if now > 3 else set())

    hit, usual = ("gripper", "table"), touched()
    assert "gripper hit the table" in told(touched(hit, lower=0.2), usual).story
    assert "gripper hit the table" not in told(touched(hit, lower=0.2), usual, touched(hit)).story


@pytest.mark.parametrize(
    ("unit", "first", "second"), [("deg", 180.0, -180.0), ("rad", 3.0, 3.0 - 6.283185307179586)]
)
def test_angles_are_the_same_a_full_turn_apart(unit: str, first: float, second: float) -> None:
    assert difference_of(first, second, unit) == pytest.approx(0.0, abs=1e-9)
    assert spread_of([first, second], unit) == pytest.approx(0.0, abs=1e-9)
    assert difference_of(first, second, "m") > 6.0


def test_of_one_run_there_is_no_spread() -> None:
    assert spread_of([3.0]) == 0.0
    assert deviation_of(3.0, 0.0, 0.5) == 6.0


def turning(*angles: float) -> Recording:
    """A tool that stands still and turns about the vertical, deg."""
    recorder = recorders.begin()
    now = [0]
    feed = Feed(lambda: now[0] / 10)
    half = [radians(angle) / 2 for angle in angles]
    feed.pose("tool", lambda: (0.0, 0.0, 1.0, cos(half[now[0]]), 0.0, 0.0, sin(half[now[0]])))
    for now[0] in range(len(angles)):
        feed.tick()
    recorders.stop()
    recorder.recording.is_simulated = True
    return recorder.recording


def pressing(*pressures: float) -> Recording:
    """A vacuum cup's pressure, kPa."""
    recorder = recorders.begin()
    now = [0]
    feed = Feed(lambda: now[0] / 10)
    feed.value("pressure", lambda: pressures[now[0]], unit="kPa")
    for now[0] in range(len(pressures)):
        feed.tick()
    recorders.stop()
    recorder.recording.is_simulated = True
    return recorder.recording


def test_a_tool_that_is_turned_on_its_way_is_described_by_the_angle_from_all_that_the_original_has() -> None:
    usual = turning(0, 30, 60, 90)
    assert told(turning(0, 30, 60, 200, 90), usual).story.startswith(
        "tool was turned by up to 110 deg on its way"
    )
    late = told(turning(0, 0, 30, 60, 90), usual)
    assert "turned by" not in late.story
    assert late.deviation <= 1.0


def sorting(colour: str, x: float, place: str = "program.py:5") -> Recording:
    """A box that ends at a distance from the table, by its colour, which a sensor reads."""
    run = beside(x)
    run.calls = [RecordedCall(0.1, 0.2, "Sensor.colour", place, None, {}, {"result": colour, ".x": x})]
    return run


@pytest.mark.parametrize(
    "blue", [sorting("blue", 0.21), sorting("red", 0.21, "program.py:7")], ids=["reading", "place"]
)
def test_runs_in_which_something_else_was_to_be_done_are_no_spread(blue: Recording) -> None:
    red, again = sorting("red", 0.0), sorting("red", 0.004)
    found = told(sorting("red", 0.012), red, again, blue)
    assert box_of(found) == pytest.approx(3.0, rel=0.05)
    assert not found.scatters


def test_where_no_two_runs_did_the_same_all_are_compared() -> None:
    assert told(sorting("red", 0.42), sorting("red", 0.0), sorting("blue", 0.21)).scatters


def test_a_turn_on_the_way_counts_a_tenth_of_one_that_remains() -> None:
    usual = turning(0, 30, 60, 90)
    passing, remaining = turning(0, 30, 60, 140, 90), turning(0, 30, 60, 90, 140)
    assert told(remaining, usual).deviation == pytest.approx(100.0)  # 50 deg, of which 0.5 count as none
    assert told(passing, usual).deviation == pytest.approx(10.0)


def test_a_small_turn_on_the_way_is_described_though_it_counts_little() -> None:
    found = told(turning(0, 30, 60, 94, 90), turning(0, 30, 60, 90))
    assert found.deviation < 1.0
    assert found.story.startswith("tool was turned by up to 4 deg on its way")


def test_a_value_that_leaves_its_range_alone_is_no_delay() -> None:
    assert told(pressing(0, 40, 52, 40), pressing(0, 40, 48, 40)).story.startswith(
        "pressure left its range in the original by up to 4 kPa"
    )


def test_things_that_left_their_paths_are_reported_together() -> None:
    way = [(x, y + (0.2 if 5 < number < 10 else 0.0), z) for number, (x, y, z) in enumerate(WAY)]
    story = told(recorded(way, way), recorded(WAY, WAY)).story
    assert "box and tool left their paths by up to 0.2 m but reached the correct end positions" in story


@pytest.mark.parametrize(("waits", "is_named"), [(6, True), (1, False)])
def test_that_a_test_took_much_longer_is_named_before_lesser_differences(waits: int, is_named: bool) -> None:
    goals = ((1.0, 0.3, 0.025), (1.2, 0.4, 0.025))
    tool, box = ([SHELF] * waits + [SHELF, *line(SHELF, goal, 1.0), *[goal] * 10] for goal in goals)
    parts = told(recorded(tool, box), recorded(WAY, WAY)).story.split("; ")
    assert len(parts) == 3
    assert any(part.startswith("the test took 2.6 s (original: 2 s)") for part in parts) is is_named


def test_what_turns_the_same_way_at_other_moments_is_not_turned_aside() -> None:
    usual = turning(*range(0, 180, 10))
    found = diverged("test", RecordedPaths(usual), RecordedPaths(turning(*range(5, 175, 10), 170)))
    assert found is not None
    (turned,) = (deviation for deviation in found.apart if deviation.name == "tool turned")
    assert turned.largest > 4.9
    assert turned.aside == pytest.approx(0.0, abs=0.2)


def test_turned_aside_is_the_angle_whatever_the_sign_of_the_quaternions() -> None:
    usual = RecordedPaths(turning(0, 30, 60)).paths["tool"].rows
    other = RecordedPaths(turning(45, 100)).paths["tool"].rows
    flipped = [(*row[:3], *(-part for part in row[3:])) for row in other]
    assert turned_aside(other, usual) == pytest.approx(40.0, abs=0.2)
    assert turned_aside(flipped, usual) == pytest.approx(40.0, abs=0.2)


def test_what_turns_to_and_fro_between_two_moments_may_have_turned_as_far_unseen() -> None:
    usual, rocking, leaning = (
        RecordedPaths(turning(*angles)).paths["tool"].rows
        for angles in ((80, 80, 88, 80, 80), (80, 72, 80, 80, 80), (80, 60, 60, 80, 80))
    )
    assert turned_aside(rocking, usual) == pytest.approx(0.0, abs=0.2)
    assert turned_aside(leaning, usual) == pytest.approx(12.0, abs=0.2)
