"""Writes videos, filmed or drawn: H.264 in MP4 for browsers, or GIF for texts such as pull requests.

Needs PyAV and Pillow: ``mutabot[video]``.

PyAV rather than a program beside Python: it encodes in this process, so nothing is left running, and it is
a quarter of the size.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import av
from PIL import Image

from mutabot.api.reports import Progress, UsageError
from mutabot_motion.pictures.film import Film
from mutabot_motion.view import MotionView
from mutabot_motion.viewers import atomic_file

from .drawn import DrawnPictures
from .frame import FilmedPictures, Frames, SidePictures

#: frames per second, at which simulated seconds become those of the video
RATE = 25
#: how long the last frame stays, s
_HELD = 1.5
#: of a GIF: pictures per second, the most it has, and how wide they are at most, pixels
_GIF_RATE, _GIF_MOST, _GIF_WIDTH = 10, 200, 720


def show(
    file: Path, view: MotionView, films: tuple[Film, Film], problems: Sequence[str], progress: Progress
) -> list[str]:
    """Write a video of both films; where pictures are missing, of both recordings, drawn.

    Args:
        films: of the original and of the mutant.
        problems: why pictures are missing, as far as it is known.
        progress: has a step per picture of the video.

    Returns what is to be said about it, one line each. Raises UsageError if there is nothing to show.
    """
    notes = []
    if all(film.times for film in films):
        sides: tuple[SidePictures, SidePictures] = FilmedPictures(films[0]), FilmedPictures(films[1])
    else:
        notes = [_why_no_pictures(problems)]
        sides = _drawn(view, notes[0])
        notes[0] += "; the paths are drawn instead"
    write = write_gif if file.suffix.lower() == ".gif" else write_video
    seconds = write(file, Frames(view, sides), progress)
    size = file.stat().st_size
    return [*notes, f"{file}: {seconds:.1f} s, {size / 1e6:.1f} MB"]


def _drawn(view: MotionView, why: str) -> tuple[SidePictures, SidePictures]:
    original = view.original
    # a mutant in which nothing that was recorded differs has no recording of its own
    mutant = view.mutant if view.mutant is not None or view.story else original
    if original is None or mutant is None or not (original.recording.tracks and mutant.recording.tracks):
        raise UsageError(
            f"there is nothing to make a video of: {why}; and no simulator reports where things are "
            "(mutabot.api.processes.Feed, see docs/motion.md)"
        )
    return DrawnPictures(original, [mutant]), DrawnPictures(mutant, [original])


def _why_no_pictures(problems: Sequence[str]) -> str:
    if not problems:
        return "no simulator gives pictures: name one by `feed.camera`, see docs/motion.md"
    return (
        f"{problems[0]} (without a screen, MuJoCo draws if Debian's libegl1 or libosmesa6 is installed; what "
        "else may help says docs/motion.md)"
    )


def write_video(file: Path, frames: Frames, progress: Progress) -> float:
    """Write a video, and remove it if it is not finished. Return its duration, s."""
    count = 0
    frame: Any = av.VideoFrame
    with atomic_file(file) as part, av.open(str(part), "w", options={"movflags": "+faststart"}) as video:
        stream = video.add_stream("libx264", rate=RATE, options={"crf": "21", "preset": "veryfast"})
        stream.width, stream.height = frames.size
        stream.pix_fmt = "yuv420p"
        moments = [*_frame_times(frames.end, frames.speed)]
        progress.stage("video", len(moments))
        for time in moments:
            video.mux(stream.encode(frame.from_image(frames.at(time))))
            count += 1
            progress.advance()
        video.mux(stream.encode(None))
    return count / RATE


def write_gif(file: Path, frames: Frames, progress: Progress) -> float:
    """Write an animation that repeats, and remove it if it is not finished. Return its duration, s.

    A long one has fewer pictures per second. Returns how long it is, s.
    """
    seconds = frames.end / frames.speed
    count = max(2, min(_GIF_MOST, int(seconds * _GIF_RATE) + 1))
    progress.stage("video", count)
    pictures = []
    for number in range(count):
        pictures.append(_indexed(frames.at(number * frames.end / (count - 1))))
        progress.advance()
    each = round(100 * seconds / (count - 1)) * 10  # the format counts in hundredths of a second
    lasting = [*[each] * (count - 1), round(1000 * _HELD)]
    with atomic_file(file) as part:
        pictures[0].save(
            part, "GIF", save_all=True, append_images=pictures[1:], duration=lasting, loop=0, optimize=False
        )
    return sum(lasting) / 1000


def _indexed(frame: Image.Image) -> Image.Image:
    """Return a frame in the size of the GIF, with a colour table of its own."""
    frame.thumbnail((_GIF_WIDTH, _GIF_WIDTH))
    return frame.quantize(128, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)


def _frame_times(end: float, speed: float) -> Iterator[float]:
    """Yield the time that each frame shows, s."""
    count = int(end / speed * RATE) + 1
    yield from (number * speed / RATE for number in range(count))
    yield from (end for _ in range(int(_HELD * RATE)))
