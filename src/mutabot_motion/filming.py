"""Films a test of the original and of a mutant: each in a fresh process, recorded, with pictures.

The pictures are the simulator's own, as ``Feed.camera`` gives them. No other run takes any.
"""

from __future__ import annotations

import ctypes.util
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import ceil
from pathlib import Path

from mutabot.api.processes import Result, Task
from mutabot.api.reports import CampaignRun, MutantResult, Progress, RecordedPaths, UsageError

from .pictures.film import Film

#: what writes the pictures, in the process of the test
_WRITER = "mutabot_motion.pictures.film:FilmWriter"
#: wall-clock seconds that a picture may take, beside those of the test; pictures per simulated second
_PER_PICTURE, _RATE = 4.0, 25.0
#: s between two looks at how far a film is
_LOOK = 1.0
_SIDES = ("original", "mutant")
#: what draws without a screen, the better first, with the library that it needs
_GRAPHICS = (("egl", "EGL"), ("osmesa", "OSMesa"))


@dataclass(frozen=True, slots=True)
class FilmedTest:
    """A filmed test.

    Attributes:
        film: its pictures, if there are any.
        recording: what else was seen of it; None if its process died.
        ended: how it ended, such as ``passed``.
        problems: why pictures are missing, one line each.
    """

    film: Film
    recording: RecordedPaths | None
    ended: str
    problems: tuple[str, ...] = ()


def choose_graphics() -> None:
    """Let simulators of new processes render without a screen, if there is none.

    It changes the environment, which MuJoCo reads, and PyOpenGL; what the user has chosen himself stays.
    """
    if "MUJOCO_GL" in os.environ or "DISPLAY" in os.environ or "WAYLAND_DISPLAY" in os.environ:
        return
    found = next((name for name, library in _GRAPHICS if ctypes.util.find_library(library)), None)
    if found is not None:
        os.environ["MUJOCO_GL"] = found
        os.environ.setdefault("PYOPENGL_PLATFORM", found)


def film(
    campaign: CampaignRun, result: MutantResult, round: int, test: str, folder: Path
) -> tuple[FilmedTest, FilmedTest]:
    """Film a test of the original and of a mutant, into a folder.

    Args:
        result: the mutant.
        round: 0-based.
        test: its node id.

    Raises UsageError if the test does not judge the mutant, as the program is now.
    """
    mutant, baseline = campaign.current(result.mutant), campaign.baseline
    judges = baseline.tests_from_first_reach(round, mutant)
    if test not in judges:
        listed = ", ".join(judges[:3]) or "no test does"
        raise UsageError(f"{test} does not judge the mutant in round {round + 1}; these do: {listed}")
    suite = baseline.suite(round)
    leading = suite[: suite.index(test) + 1]  # the test may find something of those before it
    planned = campaign.task(mutant, round, leading, stop=False)
    more = _PER_PICTURE * _RATE * (baseline.simulated(round, test) + 1.0)
    choose_graphics()  # for what is filmed alone
    found = {}
    with following_progress(campaign.progress, folder, baseline.simulated(round, test)):
        for done in campaign.executor.run(_tasks(planned, test, more, folder)):
            found[done.task.key] = _filmed_test(done, test)
    return found["original"], found["mutant"]


@contextmanager
def following_progress(progress: Progress, folder: Path, seconds: float) -> Iterator[None]:
    """Advance the progress by a step for each simulated second that is filmed, of both sides.

    What the pictures show is known here only from their files: these are looked at now and then.
    """
    total, is_over = 2 * ceil(seconds), threading.Event()
    progress.stage("film, simulated seconds", total)
    advanced = 0

    def follow(until: int = 0) -> None:
        nonlocal advanced
        ends = {name: Film(folder / f"{name}.film").end for name in _SIDES}
        line = ", ".join(f"{name} {end:.0f} s" for name, end in ends.items() if end)
        for _ in range(advanced, max(until, min(total - 1, int(sum(ends.values()))))):
            advanced += 1
            progress.advance(line)

    def watch() -> None:
        while not is_over.wait(_LOOK):
            follow()

    watcher = threading.Thread(target=watch, name="mutabot-film", daemon=True)
    watcher.start()
    try:
        yield
    finally:
        is_over.set()
        watcher.join()
    follow(total)


def _tasks(planned: Task, test: str, more: float, folder: Path) -> Iterator[Task]:
    """Yield the tasks of both sides, with ``more`` seconds for the pictures of the test."""
    limit = planned.deadlines[test].with_more(more, more)
    deadlines = {**planned.deadlines, test: limit}
    for name in _SIDES:
        job = planned.job.filmed(test, str(folder / f"{name}.film"), _WRITER)
        if name == "original":
            job = replace(job, mutant=None, instrumentation=None)
        yield replace(planned, key=name, job=job, deadlines=deadlines, deadline=limit)


def _filmed_test(result: Result, test: str) -> FilmedTest:
    pictures = result.task.job.pictures
    assert pictures is not None
    shot = Film(Path(pictures.file))
    end = next((candidate for candidate in result.ends if candidate.test == test), None)
    if end is None:
        return FilmedTest(shot, None, result.death(), (result.death(),))
    recorded = RecordedPaths.from_text(end.recording) if end.recording is not None else None
    problems = tuple(recorded.recording.problems) if recorded is not None else ()
    ended = f"timed out: {end.timeout}" if end.timeout is not None else end.outcome
    lines = (end.message or "").strip().splitlines()
    return FilmedTest(
        shot, recorded, f"{ended}: {lines[0]}" if ended == "failed" and lines else ended, problems
    )
