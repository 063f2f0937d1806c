"""Run a suite once without changes, and watch the calls of the program and of its tests."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Generic, TypeVar

from mutabot.execution.processes import command, kill_group
from mutabot.execution.task import tail_of
from mutabot.extensions import libraries, references_for_processes
from mutabot.model.codec import from_data, to_data
from mutabot.model.event_file import FOLDER
from mutabot.model.observation import JOB, SEEN, TESTS, VARIABLE, ObservationJob
from mutabot.model.process_time import TimeUsed
from mutabot.testpaths import test_paths

T = TypeVar("T")
#: of pytest, in which every assertion stays as it is written
_OWN = ("-p", "mutabot.runtime.observation_plugin", "--assert=plain")
#: seconds that pytest has for an orderly end when its time is over
_PATIENCE = 5.0


@dataclass(frozen=True)
class Observed(Generic[T]):
    """What an observed run of a suite returned.

    Attributes:
        seen: what the observer of each process returned, that of the tests' process first.
        outcomes: number of tests by outcome: ``passed``, ``failed``, ``skipped``.
        problems: the first failures, each with its test, in pytest's words.
        trouble: why less is known than after a whole run; empty if nothing is missing.
        tests: pytest's arguments that named the tests.
    """

    seen: list[T] = field(default_factory=list)
    outcomes: Mapping[str, int] = field(default_factory=dict)
    problems: Sequence[str] = ()
    trouble: str = ""
    tests: Sequence[str] = ()


def observe(
    root: Path,
    arguments: Sequence[str],
    *,
    program: Sequence[str],
    tests: Sequence[str],
    observer: str,
    result: type[T],
    limit: float,
) -> Observed[T]:
    """Run a suite once without changes, and watch the calls of the program and of its tests.

    Args:
        root: the project.
        arguments: pytest's that name the tests, such as folders; what its own ``testpaths`` names goes first.
        program, tests: files of either side, relative to ``root``, with ``/``.
        observer: ``module:Name`` of the ``Observer`` that watches in each process of the run.
        result: the dataclass that its ``data`` returns.
        limit: seconds that the run may take, without those for which it waits for a processor; it is then
            ended, and what was seen by then is returned.

    Raises ExtensionError for a package that cannot be used.
    """
    arguments = test_paths(root) or arguments
    with TemporaryDirectory(ignore_cleanup_errors=True) as name:  # nodes may still write to their logs
        home = Path(name)
        folder, log = home / FOLDER, home / "log.txt"
        folder.mkdir()
        job = ObservationJob(
            str(root), tuple(program), tuple(tests), observer, references_for_processes(), tuple(libraries())
        )
        (folder / JOB).write_text(json.dumps(to_data(job)), encoding="utf-8")
        command_line = [*command(arguments, home), *_OWN]
        is_overdue = _wait(command_line, root, {VARIABLE: str(folder)}, log, limit)
        found = replace(_read(folder, result), tests=arguments)
        if is_overdue:
            trouble = f"the tests took longer than {limit:.0f} s: only what was seen by then is known"
        elif found.outcomes:
            trouble = ""
        else:
            trouble = (
                "; ".join(found.problems[:3]) or f"no test ran{tail_of(log.read_text(errors='replace'))}"
            )
        return replace(found, trouble=trouble)


def _wait(
    command_line: Sequence[str], root: Path, variables: Mapping[str, str], log: Path, limit: float
) -> bool:
    """Run pytest. Return whether it was ended because it took too long."""
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1", **variables}
    with (
        log.open("wb") as file,
        subprocess.Popen(
            command_line, cwd=root, env=environment, stdin=subprocess.DEVNULL, stdout=file,
            stderr=subprocess.STDOUT, start_new_session=True,
        ) as process,
    ):  # fmt: skip
        try:
            used = TimeUsed.from_now()
            while (left := used.remaining(limit, None, [process.pid])[0]) > 0:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(left)  # again, if it stood in the queue for a processor in that time
                    return False
            process.send_signal(signal.SIGINT)  # as a person would: pytest ends in an orderly way
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(_PATIENCE)
            return True
        finally:
            kill_group(process.pid)
            process.wait()


def _read(folder: Path, result: type[T]) -> Observed[T]:
    own = folder / f"{TESTS}{SEEN}"
    others = sorted(path for path in folder.glob(f"*{SEEN}") if path != own)
    contents = [_data(path) for path in (own, *others)]
    seen = [from_data(result, content["seen"]) for content in contents if content]
    return Observed(seen, contents[0].get("outcomes", {}), contents[0].get("problems", ()))


def _data(path: Path) -> dict[str, Any]:
    try:
        data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8", errors="surrogateescape"))
    except (OSError, ValueError):
        return {}
    return data
