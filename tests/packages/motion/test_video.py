"""Videos, read back by the library that writes them."""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from typing import Any

import pytest

from mutabot.errors import UsageError
from mutabot.evidence.paths import RecordedPaths
from mutabot_motion.filming import following_progress
from mutabot_motion.pictures.film import Film, FilmWriter
from packages.motion.sample import recording, shown

av = pytest.importorskip("av")
Image = pytest.importorskip("PIL.Image")
ImageChops = pytest.importorskip("PIL.ImageChops")

from mutabot_motion.pictures import video  # noqa: E402
from mutabot_motion.pictures.drawn import DrawnPictures  # noqa: E402
from mutabot_motion.pictures.frame import FilmedPictures, Frames  # noqa: E402
from mutabot_motion.pictures.video import show, write_video  # noqa: E402
from mutabot_motion.viewers import check  # noqa: E402

RATE = 5


class Counted:
    """Progress that counts."""

    def __init__(self) -> None:
        self.stages: list[tuple[str, int | None]] = []
        self.steps = 0

    def stage(self, text: str, total: int | None = None) -> None:
        self.stages.append((text, total))

    def mutant_ended(self, end: Any) -> None:
        pass

    def advance(self, line: str | None = None) -> None:
        self.steps += 1

    def note(self, text: str) -> None:
        pass


SILENT = Counted()


@pytest.fixture(autouse=True)
def _few_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    """They take time."""
    monkeypatch.setattr(video, "RATE", RATE)


def film(path: Path, count: int, shade: int, height: int = 90) -> Film:
    """Pictures of one grey at ten per second; the later, the brighter."""
    writer = FilmWriter(str(path))
    for number in range(count):
        pixels = bytes([shade + number]) * (height * 120 * 3)
        writer.add(number / 10, memoryview(pixels).cast("B", (height, 120, 3)))
    return Film(path)


def frames_of(file: Path) -> tuple[Any, list[Any]]:
    with av.open(str(file)) as opened:
        stream = opened.streams.video[0]
        facts = stream.codec_context.name, stream.codec_context.pix_fmt, float(stream.average_rate)
        return facts, [frame.to_image() for frame in opened.decode(stream)]


def test_a_film_is_shown_as_it_was_at_each_time(tmp_path: Path) -> None:
    filmed = FilmedPictures(film(tmp_path / "a", 5, 100))
    found = [filmed.at(time).getpixel((0, 0))[0] for time in (0.0, 0.05, 0.1, 0.35, 9.0)]
    assert found == [100, 100, 101, 103, 104]
    assert filmed.end == 0.4


def test_a_video_is_one_that_browsers_play_and_lasts_as_long_as_the_longer_side(tmp_path: Path) -> None:
    file = tmp_path / "a.mp4"
    films = film(tmp_path / "a", 16, 60), film(tmp_path / "b", 6, 160)
    said = show(file, shown(), films, [], SILENT)
    facts, frames = frames_of(file)
    assert facts == ("h264", "yuv420p", RATE)
    assert len(frames) == int(3.0 * RATE) + 1 + int(1.5 * RATE), "1.5 s are shown in 3 s"
    assert all(side % 2 == 0 for side in frames[0].size)
    assert said == [f"{file}: {len(frames) / RATE:.1f} s, {file.stat().st_size / 1e6:.1f} MB"]
    assert [path.name for path in tmp_path.glob("*.mp4")] == ["a.mp4"]


def test_a_gif_is_as_long_as_the_longer_side_and_is_repeated(tmp_path: Path) -> None:
    file = tmp_path / "a.gif"
    said = show(file, shown(), (film(tmp_path / "a", 16, 60), film(tmp_path / "b", 6, 160)), [], SILENT)
    with Image.open(file) as opened:
        lasting, shades = [], []
        for number in range(opened.n_frames):
            opened.seek(number)
            lasting.append(opened.info["duration"])
            shades.append(opened.convert("RGB").getpixel((opened.width // 4, opened.height // 2))[0])
        assert (opened.format, opened.info["loop"]) == ("GIF", 0)
        assert opened.width <= 720
    assert sum(lasting) == 3000 + 1500, "1.5 s are shown in 3 s, and the last picture stays"
    assert (min(shades), max(shades)) == pytest.approx((60, 75), abs=3)
    assert shades == sorted(shades)
    assert said == [f"{file}: 4.5 s, {file.stat().st_size / 1e6:.1f} MB"]
    assert [path.name for path in tmp_path.glob("*.gif")] == ["a.gif"]


def test_a_long_gif_has_fewer_pictures_per_second(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(video, "_GIF_MOST", 7)
    file = tmp_path / "a.gif"
    show(file, shown(), (film(tmp_path / "a", 16, 60), film(tmp_path / "b", 6, 160)), [], SILENT)
    with Image.open(file) as opened:
        assert opened.n_frames == 7
        assert opened.info["duration"] == 500


def test_the_original_is_on_the_left_and_the_moment_of_the_fault_is_marked(tmp_path: Path) -> None:
    sides = FilmedPictures(film(tmp_path / "a", 21, 60)), FilmedPictures(film(tmp_path / "b", 21, 160))
    frames = Frames(shown(), sides)
    width, height = frames.size
    middle = height // 2
    before, after = frames.at(0.5), frames.at(1.5)
    assert before.getpixel((width // 4, middle))[0] < 100 < before.getpixel((3 * width // 4, middle))[0]
    changed = [
        x for x in range(width) if before.getpixel((x, middle))[0] + 60 < after.getpixel((x, middle))[0]
    ]
    assert changed, "a border from the fault on"
    assert min(changed) > width // 2 - 8


def test_a_side_of_another_size_is_fitted_in(tmp_path: Path) -> None:
    sides = (
        FilmedPictures(film(tmp_path / "a", 3, 60)),
        FilmedPictures(film(tmp_path / "b", 3, 160, height=40)),
    )
    frames = Frames(shown(), sides)
    assert frames.at(0.1).size == frames.size


def test_without_pictures_the_paths_are_drawn_and_why_is_said(tmp_path: Path) -> None:
    file, none = tmp_path / "a.mp4", Film(tmp_path / "none")
    said = show(file, shown(), (none, none), [], SILENT)
    assert said[0].startswith("no simulator gives pictures: name one by `feed.camera`")
    assert said[0].endswith("the paths are drawn instead")
    assert len(frames_of(file)[1]) == 4 * RATE + 1 + int(1.5 * RATE)


@pytest.mark.parametrize(
    "lacking", [{"mutant": None}, {"original": None}, {"original": RecordedPaths(recording(tracks={}))}]
)
def test_with_nothing_to_show_no_file_is_left(lacking: dict[str, Any], tmp_path: Path) -> None:
    none = Film(tmp_path / "none")
    with pytest.raises(UsageError, match=r"nothing to make a video of: no GL .*libegl1 or libosmesa6"):
        show(tmp_path / "a.mp4", shown(**lacking), (none, none), ["no GL"], SILENT)
    assert list(tmp_path.iterdir()) == []


def test_a_mutant_in_which_nothing_differs_is_drawn_as_the_original(tmp_path: Path) -> None:
    none = Film(tmp_path / "none")
    same = shown(mutant=None, story="", apart=None)
    said = show(tmp_path / "a.mp4", same, (none, none), ["the process died"], SILENT)
    assert "the process died" in said[0]
    assert (tmp_path / "a.mp4").is_file()


def test_a_video_that_is_interrupted_leaves_nothing_and_an_earlier_one_as_it_was(tmp_path: Path) -> None:
    file = tmp_path / "a.mp4"
    write_video(
        file,
        Frames(
            shown(), (DrawnPictures(RecordedPaths(recording())), DrawnPictures(RecordedPaths(recording())))
        ),
        Counted(),
    )
    before = file.read_bytes()

    class Interrupted:
        end = 2.0

        def __init__(self) -> None:
            self.calls = 0

        def at(self, time: float) -> Any:
            self.calls += 1
            if self.calls > 5:
                raise KeyboardInterrupt
            return DrawnPictures(RecordedPaths(recording())).at(time)

    found = recording()
    with pytest.raises(KeyboardInterrupt):
        write_video(file, Frames(shown(), (Interrupted(), DrawnPictures(RecordedPaths(found)))), Counted())
    assert file.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["a.mp4"]


def test_a_drawing_shows_more_as_time_goes_on_and_both_sides_in_one_scale() -> None:
    original, mutant = RecordedPaths(recording()), RecordedPaths(recording(lets_go=True))
    drawn = DrawnPictures(original, [mutant])
    early, late = drawn.at(0.2), drawn.at(2.0)
    ground = {early.getpixel((1, 1)), late.getpixel((1, 1))}
    assert len(ground) == 1
    empty = next(iter(ground))
    count = [{colour: n for n, colour in image.getcolors(1 << 20)}[empty] for image in (early, late)]
    assert count[0] > count[1], "less of the ground is seen"
    # until the box is let go, both look the same to the last pixel
    assert DrawnPictures(mutant, [original]).at(0.9).tobytes() == drawn.at(0.9).tobytes()
    assert DrawnPictures(mutant, [original]).at(1.5).tobytes() != drawn.at(1.5).tobytes()


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("a.avi", "must end in .mp4 or .gif"),
        ("folder.mp4", "it is a folder"),
        ("nowhere/a.mp4", "there is no folder"),
        ("text.mp4", "a file of that name exists and is not a video"),
        ("text.gif", "a file of that name exists and is not a video"),
    ],
)
def test_a_file_that_cannot_be_a_video_is_refused_beforehand(name: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "folder.mp4").mkdir()
    for kind in ("mp4", "gif"):
        (tmp_path / f"text.{kind}").write_text("my notes")
    with pytest.raises(UsageError, match=told):
        check(tmp_path / name, ".mp4", ".gif")
    assert (tmp_path / "text.mp4").read_text() == "my notes"


@pytest.mark.parametrize(
    ("end", "speed"), [(0.0, 0.125), (0.9, 0.25), (3.0, 1.0), (120.0, 1.0), (600.0, 8.0)]
)
def test_what_is_short_is_shown_slowly_and_what_is_long_quickly(end: float, speed: float) -> None:
    drawn = DrawnPictures(RecordedPaths(recording()))
    drawn.end = end
    assert Frames(shown(), (drawn, drawn)).speed == speed


def test_texts_of_any_length_and_script_find_room(tmp_path: Path) -> None:
    long = "é→−中" * 200
    frames = Frames(
        shown(what=long, test=long, story=long + " " + long, place=long),
        (DrawnPictures(RecordedPaths(recording())), DrawnPictures(RecordedPaths(recording()))),
    )
    assert [frames.at(time).size for time in islice((0.0, 1.2, 2.0), 3)] == [frames.size] * 3


@pytest.mark.parametrize("name", ["a.mp4", "a.gif"])
def test_each_picture_of_a_video_is_a_step_of_its_progress(tmp_path: Path, name: str) -> None:
    progress = Counted()
    films = film(tmp_path / "a", 16, 60), film(tmp_path / "b", 6, 160)
    show(tmp_path / name, shown(), films, [], progress)
    assert progress.stages == [("video", progress.steps)]
    assert progress.steps > 5


def test_how_far_a_film_is_counts_the_simulated_seconds_of_both_sides(tmp_path: Path) -> None:
    progress = Counted()
    with following_progress(progress, tmp_path, 1.4):
        film(tmp_path / "original.film", 12, 60)
    assert progress.stages == [("film, simulated seconds", 4)]
    assert progress.steps == 4


def test_an_arm_is_drawn_where_it_is_at_each_moment() -> None:
    found = recording()
    drawn = DrawnPictures(RecordedPaths(found))
    del found.tracks["arm"]
    bare = DrawnPictures(RecordedPaths(found))
    begin, end = (ImageChops.difference(drawn.at(time), bare.at(time)).getbbox() for time in (0.0, 2.0))
    assert begin is not None
    assert end is not None
    assert end[2] > begin[2] + 100, "the arm reaches farther to the right"
