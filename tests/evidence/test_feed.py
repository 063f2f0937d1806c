"""Feeds: what a simulator tells, and that it costs nothing while nobody listens."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import isnan

import pytest

from mutabot.evidence import Feed
from mutabot.evidence import recorder as recorders
from mutabot.evidence.recorder import WorldRecorder
from mutabot.evidence.recording import Recording


@pytest.fixture
def recorder() -> Iterator[WorldRecorder]:
    yield recorders.begin()
    recorders.stop()


class World:
    """A clock and a height."""

    def __init__(self, start: float = 0.0) -> None:
        self.time = start
        self.height = 0.0
        self.reads = 0

    def read(self) -> tuple[float, float, float]:
        self.reads += 1
        return (0.0, 0.0, self.height)

    def run(self, feed: Feed, seconds: float, step: float = 0.01) -> None:
        for _ in range(round(seconds / step)):
            self.time += step
            self.height += step
            feed.tick()


def heights(recording: Recording, name: str = "tool") -> list[float]:
    return list(recording.tracks[name].values[2::3])


def fed(world: World, rate: float = 10.0) -> Feed:
    feed = Feed(lambda: world.time, rate=rate)
    feed.point("tool", world.read)
    return feed


def test_nothing_is_read_while_nothing_is_recorded() -> None:
    world = World()
    world.run(fed(world), 1.0)
    assert world.reads == 0


def test_moments_come_at_the_rate_of_simulated_time(recorder: WorldRecorder) -> None:
    world = World()
    world.run(fed(world, rate=5.0), 2.0)
    times = recorder.recording.times
    assert len(times) == 11
    steps = [after - before for before, after in pairwise(times[1:])]
    assert steps == pytest.approx([0.2] * 9)


def test_a_world_that_is_there_already_begins_at_zero(recorder: WorldRecorder) -> None:
    world = World(start=100.0)
    world.run(fed(world), 1.0)
    assert recorder.recording.times[0] == 0.0
    assert recorder.recording.times[-1] == pytest.approx(1.0, abs=0.02)


def test_a_clock_that_begins_anew_is_counted_on(recorder: WorldRecorder) -> None:
    world = World()
    feed = fed(world)
    world.run(feed, 1.0)
    world.time = 0.0
    world.run(feed, 1.0)
    times = list(recorder.recording.times)
    assert times == sorted(times)
    assert times[-1] == pytest.approx(2.0, abs=0.05)


def test_a_second_world_of_a_test_comes_after_the_first(recorder: WorldRecorder) -> None:
    first, second = World(), World()
    first.run(fed(first), 1.0)
    second.run(fed(second), 1.0)
    assert list(recorder.recording.times) == sorted(recorder.recording.times)
    assert len(heights(recorder.recording)) == len(recorder.recording.times)


def test_what_comes_later_was_not_there_before(recorder: WorldRecorder) -> None:
    world = World()
    feed = fed(world)
    world.run(feed, 0.5)
    feed.value("opening", lambda: 0.25, unit="m")
    world.run(feed, 0.5)
    opening = recorder.recording.tracks["opening"].values
    assert len(opening) == len(recorder.recording.times)
    assert isnan(opening[0])
    assert opening[-1] == 0.25


def test_long_tests_are_thinned_evenly(recorder: WorldRecorder) -> None:
    world = World()
    world.run(fed(world), 1000.0, step=0.1)
    times = recorder.recording.times
    assert 2000 <= len(times) < 4000
    steps = {round(after - before, 6) for before, after in pairwise(times[5:-5])}
    assert max(steps) <= 2 * min(steps) + 1e-6


@pytest.mark.parametrize(
    ("read", "why"),
    [
        (lambda: (1.0, 2.0), "2 numbers instead of 3"),
        (lambda: 1 / 0, "ZeroDivisionError: division by zero"),
        (lambda: "far", "TypeError"),
    ],
)
def test_what_cannot_be_read_is_said_and_the_test_goes_on(
    recorder: WorldRecorder, read: object, why: str
) -> None:
    world = World()
    feed = fed(world)
    feed.point("box", read)  # type: ignore[arg-type]  # what users may do
    world.run(feed, 1.0)
    (problem,) = recorder.recording.problems
    assert problem.startswith("box cannot be recorded: ")
    assert why in problem
    assert len(heights(recorder.recording)) == len(recorder.recording.times)
    assert all(map(isnan, recorder.recording.tracks["box"].values))


def test_contacts_are_reported_when_they_begin_and_end(recorder: WorldRecorder) -> None:
    world = World()
    feed = fed(world)
    feed.contacts(lambda: [("box", "arm"), ("arm", "box")] if 0.3 < world.time < 0.6 else [])
    world.run(feed, 1.0)
    assert [(moment.what, moment.text) for moment in recorder.recording.moments] == [
        ("touch", "arm, box"),
        ("part", "arm, box"),
    ]


def test_where_everything_ended_is_reported_whenever_that_was(recorder: WorldRecorder) -> None:
    world = World()
    feed = fed(world, rate=1.0)
    world.run(feed, 2.5)
    recorder.finish()
    assert heights(recorder.recording)[-1] == pytest.approx(2.5)
    assert recorder.recording.times[-1] == pytest.approx(2.49)


@pytest.mark.parametrize("time", [lambda: 1 / 0, lambda: float("nan"), lambda: None])
def test_a_time_that_cannot_be_read_is_said_and_the_test_goes_on(
    recorder: WorldRecorder, time: object
) -> None:
    feed = Feed(time)  # type: ignore[arg-type]  # what users may do
    feed.point("tool", lambda: (0.0, 0.0, 0.0))
    feed.tick()
    feed.note("here")
    (problem,) = recorder.recording.problems
    assert problem.startswith("the simulated time cannot be read: ")
    assert not recorder.recording.times


def test_a_simulator_that_is_closed_leaves_the_time_as_it_was(recorder: WorldRecorder) -> None:
    world = World()
    is_open = [True]

    def told() -> float:
        if not is_open[0]:
            raise RuntimeError("it is closed")
        return world.time

    feed = Feed(told)
    feed.point("tool", world.read)
    world.run(feed, 1.0)
    is_open[0] = False
    assert recorder.now == recorder.now == pytest.approx(0.99)
    recorder.finish()
    assert recorder.recording.problems == ["the simulated time cannot be read: RuntimeError: it is closed"]


def test_bodies_may_be_numbers(recorder: WorldRecorder) -> None:
    world = World()
    feed = fed(world)
    feed.contacts(lambda: [(7, 3)])  # type: ignore[list-item]  # what users may do
    world.run(feed, 0.2)
    assert [moment.text for moment in recorder.recording.moments] == ["3, 7"]


def test_a_rate_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="above 0"):
        Feed(lambda: 0.0, rate=0.0)


def test_a_line_has_three_numbers_per_radius_and_others_are_a_problem(recorder: WorldRecorder) -> None:
    world = World()
    feed = Feed(lambda: world.time)
    feed.line("arm", lambda: [0.0, 0.0, world.height, 1.0, 0.0, 0.0], radii=[0.05, 0.04])
    feed.line("wrong", lambda: [0.0, 0.0, 0.0], radii=[0.05, 0.04])
    world.run(feed, 1.0)
    arm, wrong = recorder.recording.tracks["arm"], recorder.recording.tracks["wrong"]
    assert arm.radii == (0.05, 0.04)
    assert len(arm.values) == len(wrong.values) == 6 * len(recorder.recording.times)
    assert all(map(isnan, wrong.values))
    assert recorder.recording.problems == ["wrong cannot be recorded: 3 numbers instead of 6"]


def test_a_line_is_kept_to_a_millimetre_and_what_is_compared_as_it_is(recorder: WorldRecorder) -> None:
    feed = Feed(lambda: 0.0)
    feed.line("arm", lambda: [0.12345, -0.6789, 1.0], radii=[0.05])
    feed.point("tool", lambda: (0.12345, -0.6789, 1.0))
    feed.tick()
    arm, tool = (list(recorder.recording.tracks[name].values) for name in ("arm", "tool"))
    assert arm == pytest.approx(tool, abs=0.0005)
    assert arm != tool
    assert tool == pytest.approx([0.12345, -0.6789, 1.0], abs=1e-6)
