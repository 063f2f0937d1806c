"""One test of the original and of a mutant, filmed: each in a fresh process, recorded, with pictures.

The pictures are the simulator's own, as ``Feed.camera`` gives them. No other run takes any.
"""

from __future__ import annotations

import ctypes.util
import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from mutabot.campaign.campaign import Campaign
from mutabot.errors import SelectionError
from mutabot.evidence.recording import Recording, bytes_of, from_bytes
from mutabot.execution.task import Result, Task
from mutabot.model import Mutant
from mutabot.model.events import TestEnd
from mutabot.model.job import Job, Pictures
from mutabot_motion.pictures.film import Film

#: wall-clock seconds that a picture may take, beside those of the test; pictures per simulated second
_PER_PICTURE, _RATE = 4.0, 25.0
#: what draws without a screen, the better first, with the library that it needs
_GRAPHICS = (("egl", "EGL"), ("osmesa", "OSMesa"))


@dataclass(frozen=True, slots=True)
class Take:
    """One test, filmed.

    Attributes:
        film: its pictures, if there are any.
        recording: what else was seen of it; None if its process died.
        ended: how it ended, in words, such as ``passed``.
        problems: why pictures are missing, one line each.
    """

    film: Film
    recording: Recording | None
    ended: str
    problems: tuple[str, ...] = ()


def choose_graphics() -> None:
    """Let simulators of processes that start from now on draw without a screen, if there is none.

    It changes the environment, which MuJoCo reads, and PyOpenGL; what the user has chosen himself stays.
    """
    if "MUJOCO_GL" in os.environ or "DISPLAY" in os.environ or "WAYLAND_DISPLAY" in os.environ:
        return
    found = next((name for name, library in _GRAPHICS if ctypes.util.find_library(library)), None)
    if found is not None:
        os.environ["MUJOCO_GL"] = found
        os.environ.setdefault("PYOPENGL_PLATFORM", found)


def film(campaign: Campaign, mutant: Mutant, round: int, test: str, folder: Path) -> tuple[Take, Take]:
    """Film a test of the original and of a mutant, into a folder.

    Args:
        round: 0-based.
        test: its node id.

    Raises SelectionError if the test does not judge the mutant, as the program is now.
    """
    tests = _leading_to(campaign, mutant, round, test)
    campaign.progress.stage("film", 2)
    found = {}
    for result in campaign.executor.run(_tasks(campaign, mutant, round, tests, folder)):
        found[result.task.key] = _take(result, test)
        campaign.progress.advance(f"{result.task.key}: {found[result.task.key].ended}")
    return found["original"], found["mutant"]


def _leading_to(campaign: Campaign, mutant: Mutant, round: int, test: str) -> tuple[str, ...]:
    """The test, and before it the tests of which it may find something."""
    baseline = campaign.baseline
    judges = baseline.tests_judging(round, mutant)
    if test not in judges:
        listed = ", ".join(judges[:3]) or "no test does"
        problem = f"{test} does not judge the mutant in round {round + 1}; these do: {listed}"
        raise SelectionError(problem)
    suite = baseline.suite(round)
    return suite[: suite.index(test) + 1]


def _tasks(
    campaign: Campaign, mutant: Mutant, round: int, tests: tuple[str, ...], folder: Path
) -> Iterator[Task]:
    planned = campaign.task(mutant, round, tests, stop=False)
    for name, whose in (("original", None), ("mutant", mutant)):
        job: Job = replace(
            planned.job,
            mutant=whose,
            stop_at_kill=False,
            instrumentation=planned.job.instrumentation if whose is not None else None,
            memory=None,  # libraries of graphics reserve far more addresses than they use
            evidence=True,
            pictures=Pictures(tests[-1], str(folder / f"{name}.film")),
        )
        simulated = campaign.baseline.ends[round, tests[-1]].simulated or 0.0
        more = _PER_PICTURE * _RATE * (simulated + 1.0)
        limit = planned.deadlines[tests[-1]].with_more(more, more)
        yield replace(
            planned, key=name, job=job, deadlines={**planned.deadlines, tests[-1]: limit}, deadline=limit
        )


def _take(result: Result, test: str) -> Take:
    pictures = result.task.job.pictures
    assert pictures is not None
    shot = Film(Path(pictures.file))
    end = next((one for one in result.ends if one.test == test), None)
    if end is None:
        return Take(shot, None, result.death(), (result.death(),))
    recording = from_bytes(bytes_of(end.recording)) if end.recording is not None else None
    problems = tuple(recording.problems) if recording is not None else ()
    return Take(shot, recording, _ended(end), problems)


def _ended(end: TestEnd) -> str:
    if end.timeout is not None:
        return f"timed out: {end.timeout}"
    lines = (end.message or "").strip().splitlines()
    return f"{end.outcome}: {lines[0]}" if end.outcome == "failed" and lines else end.outcome
