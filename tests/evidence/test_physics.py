"""What is measured of motions and contacts: heights, speeds, slips, drags and collisions."""

from __future__ import annotations

from math import sqrt

import pytest

from mutabot.evidence import recorder as recorders
from mutabot.evidence.feed import Feed
from mutabot.evidence.paths import RecordedPaths
from mutabot.evidence.physics import COLLISION, DRAG, DURATION, IMPACT, RELEASE, SLIP, SPEED, Fact, facts_of
from mutabot.evidence.recording import Recording
from tests.evidence.worlds import SHELF, TABLE, UPRIGHT, Place, apart, line, recorded

#: half of a box's edge, and the height of the table's top, m
HALF, TOP = 0.025, 0.0
HELD, LYING, THERE = ("box", "gripper"), ("box", "shelf"), ("box", "table")
ABOVE: Place = (1.0, 0.0, 0.525)
WAY = [SHELF, *line(SHELF, (0.0, 0.0, 0.525), 0.5), *line((0.0, 0.0, 0.525), ABOVE, 2.0)]


def falling(start: Place, ground: float = TABLE[2]) -> list[Place]:
    """Places of a free fall, ten a second, until it lies."""
    x, y, z = start
    heights = [z - 9.81 * (number / 10) ** 2 / 2 for number in range(1, 30)]
    return [(x, y, max(height, ground)) for height in heights]


def facts(*args: object) -> dict[tuple[str, str], Fact]:
    return facts_of(RecordedPaths(recorded(*args)))  # type: ignore[arg-type]


def dropped(height: float) -> dict[tuple[str, str], Fact]:
    """A box that is let go so high above the table."""
    start = (1.0, 0.0, TABLE[2] + height)
    way = [SHELF, *line(SHELF, start, 2.0), start, start]
    box = [*way, *falling(start)]
    lands = next(number for number, place in enumerate(box) if number > 20 and place[2] <= TABLE[2])

    def touching(now: int) -> set[tuple[str, str]]:
        found = {LYING} if now == 0 else set()
        if now < len(way):
            found.add(HELD)
        if now >= lands:
            found.add(THERE)
        return found

    return facts([*way, *[start] * (len(box) - len(way))], box, touching)


@pytest.mark.parametrize("height", [0.05, 0.23, 0.53, 1.2])
def test_a_box_hits_the_table_as_fast_as_it_falls_from_where_it_is_let_go(height: float) -> None:
    found = dropped(height)
    assert found[RELEASE, "box"].value == pytest.approx(height, abs=1e-3)
    assert found[RELEASE, "box"].other == "table"
    assert found[IMPACT, "box"].value == pytest.approx(sqrt(2 * 9.81 * height), rel=0.02)


def test_a_box_that_stands_when_it_is_let_go_falls_from_nowhere() -> None:
    way = [SHELF, *line(SHELF, TABLE, 2.0)]
    box = [*way, *[TABLE] * 5]

    def touching(now: int) -> set[tuple[str, str]]:
        return ({HELD} if now < 23 else set()) | ({THERE} if now >= 20 else set())

    found = facts(box, box, touching)
    assert found[RELEASE, "box"].value == 0.0
    assert found[IMPACT, "box"].value == 0.0


@pytest.mark.parametrize(("height", "hits"), [(0.003, False), (0.05, True)])
def test_what_is_set_down_hits_nothing_however_fast_it_was_carried_there(height: float, hits: bool) -> None:
    start = (1.0, 0.0, TABLE[2] + height)
    box = [SHELF, *line(SHELF, start, 2.0), TABLE, TABLE]
    tool = [*box[:21], start, start]
    found = facts(tool, box, lambda now: {LYING, HELD} if now == 0 else {HELD} if now < 21 else {THERE})
    assert found[RELEASE, "box"].value == pytest.approx(height)
    assert (found[IMPACT, "box"].value > 0.3) is hits


@pytest.mark.parametrize("slip", [0.0, 0.03])
def test_a_slip_is_how_far_a_box_moves_in_the_grip(slip: float) -> None:
    tool = [SHELF, *line(SHELF, ABOVE, 2.0)]
    box = [(x, y, z - slip * number / 20) for number, (x, y, z) in enumerate(tool)]
    found = facts(tool, box, lambda now: {HELD} if now >= 1 else {LYING})
    assert found[SLIP, "box"].value == pytest.approx(slip * 19 / 20, abs=1e-6)


def handed_over(apart: float) -> Recording:
    """Two tools that stand so far apart, m: one brings a box to the other, which carries it on.

    The second one touches another thing on its way.
    """
    left = [SHELF, *line(SHELF, ABOVE, 2.0), ABOVE, ABOVE, *line(ABOVE, SHELF, 2.0)]
    taken = [ABOVE] * 23 + [*line(ABOVE, (3.0, 0.0, SHELF[2]), 2.0)]
    right = [(x + apart, y, z) for x, y, z in taken]
    box = left[:23] + taken[23:]
    recorder = recorders.begin()
    now = [0]
    feed = Feed(lambda: now[0] / 10)
    for name, places in (("left/tool", left), ("right/tool", right)):
        feed.pose(name, lambda places=places: (*places[now[0]], *UPRIGHT))  # type: ignore[misc]
    feed.pose("box", lambda: (*box[now[0]], *UPRIGHT), size=(0.05, 0.05, 0.05))
    feed.contacts(lambda: touching(now[0]), robots=("left/hand", "right/hand"))

    def touching(at: int) -> set[tuple[str, str]]:
        found = {("box", "left/hand")} if at <= 22 else set()
        if at >= 20:
            found.add(("box", "right/hand"))
        return found | ({("left/hand", "post")} if at > 30 else set())

    for now[0] in range(len(left)):
        feed.tick()
    recorders.stop()
    return recorder.recording


@pytest.mark.parametrize("apart", [0.0, 0.1, -0.4])
def test_a_box_that_one_robot_hands_to_another_slips_in_neither_grip(apart: float) -> None:
    found = facts_of(RecordedPaths(handed_over(apart)))
    assert found[SLIP, "box"].value == pytest.approx(0.0, abs=1e-6)


def test_a_collision_has_the_speed_of_the_robot_that_collides() -> None:
    found = facts_of(RecordedPaths(handed_over(0.1)))
    assert found[COLLISION, "left/hand, post"].value == pytest.approx(0.5, rel=1e-3)  # the other: 1 m/s


def test_a_drag_is_the_way_over_what_a_box_stands_on_while_a_robot_touches_it() -> None:
    way = [SHELF, *line(SHELF, (0.3, 0.0, SHELF[2]), 1.0)]
    found = facts(way, way, lambda now: {HELD, LYING})
    assert found[DRAG, "box"].value == pytest.approx(0.3, abs=1e-6)
    assert found[DRAG, "box"].other == "shelf"


def test_what_a_conveyor_carries_is_not_dragged() -> None:
    way = [SHELF, *line(SHELF, (0.6, 0.0, SHELF[2]), 2.0)]
    found = facts(way, way, lambda now: {LYING, HELD} if now > 15 else {LYING})
    assert (DRAG, "box") not in found


def test_a_collision_has_the_speed_of_the_tool_just_before() -> None:
    way = [SHELF, *line(SHELF, (0.5, 0.0, SHELF[2]), 1.0)]
    found = facts(
        way, [SHELF] * len(way), lambda now: {LYING} | ({("gripper", "table")} if now > 8 else set())
    )
    assert found[COLLISION, "gripper, table"].value == pytest.approx(0.5, rel=1e-3)
    assert found[COLLISION, "gripper, table"].at == pytest.approx(0.9)


def test_the_greatest_speed_and_the_duration_are_those_of_the_whole_test() -> None:
    found = facts([*line(SHELF, ABOVE, 4.0), *line(ABOVE, SHELF, 1.0)])
    assert found[SPEED, "tool"].value == pytest.approx(1.0, rel=1e-3)
    assert found[DURATION, "test"].value == pytest.approx(4.9)


def test_a_second_world_in_a_test_is_no_leap() -> None:
    recording = recorded([SHELF, SHELF, ABOVE, ABOVE])
    recording.times[2:] = type(recording.times)("d", [0.101, 0.201])
    assert facts_of(RecordedPaths(recording))[SPEED, "tool"].value == 0.0


def with_margin(*margins: float, rises: float = 0.0) -> Recording:
    """A tool beside a limit, which stands still until it rises at last, m."""
    recorder = recorders.begin()
    now = [0]
    feed = Feed(lambda: now[0] / 10)
    feed.point("tool", lambda: (0.0, 0.0, 1.0 + (rises if now[0] == len(margins) - 1 else 0.0)))
    feed.value("joint limit margin", lambda: margins[now[0]], unit="deg")
    for now[0] in range(len(margins)):
        feed.tick()
    recorders.stop()
    recorder.recording.is_simulated = True
    return recorder.recording


@pytest.mark.parametrize(
    ("margins", "story"),
    [
        ((40.0, 2.1, 40.0), "joint limit margin fell to 2.1 deg (original: 38 deg)"),
        ((40.0, 30.0, 40.0), "the same movements happened at most 0.1 s earlier or later"),
        ((40.0, 39.0, 60.0), "the same movements happened at most 0.1 s earlier or later"),
    ],
)
def test_how_near_to_a_limit_is_reported_if_it_is_much_nearer(margins: tuple[float, ...], story: str) -> None:
    found = apart(with_margin(40.0, 38.0, 40.0), with_margin(*margins))
    assert found is not None
    assert found.story == story


def test_the_first_difference_is_where_the_robot_is_rather_than_how_near_to_a_limit() -> None:
    found = apart(with_margin(40.0, 38.0, 40.0), with_margin(40.0, 30.0, 40.0, rises=0.1))
    assert found is not None
    assert found.what == "tool is at a different position than in the original run"
    assert found.at == pytest.approx(0.2)
