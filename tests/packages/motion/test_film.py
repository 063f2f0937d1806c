"""Pictures of a test: what feeds take when it is filmed, and never else; what comes out of the file again."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mutabot.evidence import Feed, recorder
from mutabot_motion.pictures.film import Film, FilmWriter


def picture(pixels: bytes, height: int, width: int, depth: int = 3) -> memoryview:
    return memoryview(pixels).cast("B", (height, width, depth))


@st.composite
def pictures(draw: Any) -> tuple[int, int, bytes]:
    height, width = draw(st.integers(1, 4)), draw(st.integers(1, 4))
    return height, width, draw(st.binary(min_size=height * width * 3, max_size=height * width * 3))


@settings(max_examples=40, deadline=None)
@given(taken=st.lists(pictures(), max_size=6))
def test_every_picture_comes_out_as_it_went_in(
    taken: list[tuple[int, int, bytes]], tmp_path_factory: Any
) -> None:
    file = tmp_path_factory.mktemp("film") / "a.film"
    writer = FilmWriter(str(file))
    for number, (height, width, pixels) in enumerate(taken):
        writer.add(number / 8, picture(pixels, height, width))
    writer.close()
    film = Film(file)
    found = [(frame.time, frame.height, frame.width, frame.pixels) for frame in film.pictures()]
    assert found == [(number / 8, *frame) for number, frame in enumerate(taken)]
    assert film.times == [frame[0] for frame in found]


@settings(max_examples=40, deadline=None)
@given(cut=st.integers(1, 40))
def test_of_a_film_that_was_cut_off_whole_pictures_are_left(cut: int, tmp_path_factory: Any) -> None:
    file = tmp_path_factory.mktemp("film") / "a.film"
    writer = FilmWriter(str(file))
    for number in range(3):
        writer.add(number, picture(bytes(range(number, number + 12)), 2, 2))
    writer.close()
    file.write_bytes(file.read_bytes()[:-cut])
    times = Film(file).times
    assert times == [0.0, 1.0, 2.0][: len(times)]
    assert len(times) < 3
    assert len(list(Film(file).pictures())) == len(times)


def test_the_fourth_number_of_each_pixel_is_left_out(tmp_path: Path) -> None:
    FilmWriter(str(tmp_path / "a")).add(0.0, picture(b"rgbARGBa", 1, 2, 4))
    assert next(Film(tmp_path / "a").pictures()).pixels == b"rgbRGB"


def test_a_film_that_was_never_made_has_no_pictures(tmp_path: Path) -> None:
    assert Film(tmp_path / "none").times == []


class World:
    """A simulator of a tenth of a second per step, and its feed."""

    def __init__(self, **options: Any) -> None:
        self.time = 0.0
        self.taken: list[float] = []
        self.feed = Feed(lambda: self.time)
        self.feed.camera(self.camera, **options)

    def camera(self) -> Any:
        self.taken.append(self.time)
        return picture(bytes(12), 2, 2)

    def run(self, steps: int) -> None:
        for _ in range(steps):
            self.time = round(self.time + 0.1, 6)
            self.feed.tick()


@pytest.fixture(autouse=True)
def _no_tape() -> Iterator[None]:
    yield
    recorder.stop()


def test_no_picture_is_taken_outside_of_a_campaign_nor_in_an_ordinary_one() -> None:
    world = World()
    world.run(5)
    recorder.begin()
    world.run(5)
    assert world.taken == []


def test_pictures_come_at_their_own_rate_of_simulated_time(tmp_path: Path) -> None:
    world = World(rate=2.5)
    recorder.begin(FilmWriter(str(tmp_path / "a")))
    world.run(13)
    assert Film(tmp_path / "a").times == pytest.approx([0.0, 0.3, 0.7, 1.1], abs=0.1)
    assert len(world.taken) == 4


def test_a_camera_that_fails_is_asked_once_and_the_test_goes_on(tmp_path: Path) -> None:
    world = World()
    asked = []
    world.feed.camera(lambda: asked.append(1) or 1 / 0)
    found = recorder.begin(FilmWriter(str(tmp_path / "a")))
    world.run(5)
    assert len(asked) == 1
    assert found.recording.problems == ["pictures cannot be taken: ZeroDivisionError: division by zero"]


@pytest.mark.parametrize(
    "wrong", [b"123", memoryview(bytes(12)).cast("B", (4, 3)), memoryview(bytes(16)).cast("I", (2, 2, 1))]
)
def test_what_is_no_picture_is_reported_with_what_one_is(wrong: Any, tmp_path: Path) -> None:
    world = World()
    world.feed.camera(lambda: wrong)
    found = recorder.begin(FilmWriter(str(tmp_path / "a")))
    world.run(1)
    assert "a picture has the shape (height, width, 3)" in found.recording.problems[0]


def test_a_camera_that_has_no_picture_yet_is_asked_again(tmp_path: Path) -> None:
    world = World(rate=10)
    found: list[Any] = [None, None, picture(bytes(3), 1, 1)]
    world.feed.camera(lambda: found.pop(0) if found else None)
    recorder.begin(FilmWriter(str(tmp_path / "a")))
    world.run(6)
    assert len(Film(tmp_path / "a").times) == 1


def test_of_two_simulations_the_later_one_is_filmed(tmp_path: Path) -> None:
    first, second = World(), World()
    recorder.begin(FilmWriter(str(tmp_path / "a")))
    first.run(2)
    second.run(2)
    before = len(first.taken)
    first.run(2)
    second.run(2)
    assert len(first.taken) == before > 0
    assert Film(tmp_path / "a").times == sorted(Film(tmp_path / "a").times)


def test_a_simulation_that_begins_anew_goes_on_in_the_same_film(tmp_path: Path) -> None:
    world = World(rate=10)
    recorder.begin(FilmWriter(str(tmp_path / "a")))
    world.run(3)
    world.time = 0.0
    world.run(3)
    times = Film(tmp_path / "a").times
    assert times == sorted(times)
    assert len(times) >= 5


@pytest.mark.parametrize("rate", [0, -1.0])
def test_a_rate_that_is_none_is_refused(rate: float) -> None:
    with pytest.raises(ValueError, match="above 0, such as 25"):
        World(rate=rate)
