"""A process below the tests loads the rest of mutabot as soon as it matters, and not before."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mutabot.model import Choice, Instrumentation, Vocabulary
from mutabot.model.event_file import FOLDER, EventReader
from mutabot.model.events import Began, Did, Event, PlacesReached, Raised, SessionEnd, Signalled
from mutabot.model.job import Job, write_job
from mutabot.runtime.processes.environment import Now
from mutabot.runtime.processes.members import _write_wake
from mutabot_source.texts import find_texts
from tests.runtime.processes.test_startup import KEY, run

PROGRAM = """
def half(number):
    return number / 2

def more(number):
    return number + 1

if __name__ == "__main__":
    print(half(8))
"""
#: whether the process has become a member
LOADED = "import sys; print('mutabot.runtime.processes.member' in sys.modules)"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project whose mutant has another operator in ``half``, and the folder of its processes."""
    root = tmp_path / "project"
    root.mkdir()
    (root / "halves.py").write_text(PROGRAM, encoding="utf-8")
    (text,) = find_texts(root, ["halves.py"], ["AOR"])
    place = next(one for one in text.places if one.text == "number / 2")
    index = next(number for number, one in enumerate(place.alternatives) if one.text.count("*") == 1)
    choice = Choice(place.number, index)
    text = Instrumentation((text,)).only((choice,))
    home = root / "home"
    (home / FOLDER).mkdir(parents=True)
    job = Job(str(root), ("halves.py",), (), Vocabulary(), 1, 0, record=True, instrumentation=text, key=KEY)
    write_job(home, job)
    _write_wake(str(home / FOLDER), job)
    Now(str(home / FOLDER), is_host=True).begin("test_halves.py::test_half")
    return root


def ran(project: Path, *arguments: str) -> tuple[str, list[Event]]:
    """What a process prints, and the events of its file."""
    done = run(sys.executable, *arguments, folder=project / "home" / FOLDER, more=str(project))
    (file,) = (project / "home" / FOLDER).glob("*.jsonl")
    reader = EventReader(str(file), KEY)
    events = reader.read(is_last=True)
    assert reader.damage is None
    return done.stdout, events


def kinds(events: list[Event]) -> list[type[Event]]:
    return [type(one) for one in events]


def hits(events: list[Event]) -> int:
    return sum(one.hits for one in events if isinstance(one, Did))


def test_a_process_that_does_not_reach_the_mutant_tells_that_it_was_there_and_loads_nothing(
    project: Path,
) -> None:
    printed, events = ran(project, "-c", f"import halves; print(halves.more(1)); {LOADED}")
    assert printed == "2\nFalse\n"
    assert kinds(events) == [Began, SessionEnd]
    (began, _) = events
    assert isinstance(began, Began)
    assert began.test == 1
    assert began.command[1] == "-c"


@pytest.mark.parametrize(
    "way",
    [
        ["-c", "import halves; print(halves.half(8))"],
        ["-m", "halves"],
        ["-c", "import halves, runpy; runpy.run_path(halves.__file__, run_name='__main__')"],
    ],
    ids=["imported", "run as a module", "run by its path"],
)
def test_the_mutant_acts_where_it_is_reached(project: Path, way: list[str]) -> None:
    printed, events = ran(project, *way)
    assert printed == "16\n"
    assert hits(events) == 1
    assert kinds(events).count(Began) == kinds(events).count(SessionEnd) == 1


def test_the_mutant_acts_where_the_program_is_run_as_a_script(project: Path) -> None:
    printed, events = ran(project, str(project / "halves.py"))
    assert (printed, hits(events)) == ("16\n", 1)


def test_the_mutant_acts_in_a_script_that_a_module_runs_by_its_path(project: Path) -> None:
    (project / "runs.py").write_text(
        "import halves, runpy\nrunpy.run_path(halves.__file__, run_name='__main__')\n"
    )
    printed, events = ran(project, "-m", "runs")
    assert (printed, hits(events)) == ("16\n", 1)


def test_the_mutant_acts_in_a_thread_and_in_a_fork(project: Path) -> None:
    threads = "import halves, threading; threading.Thread(target=lambda: print(halves.half(8))).start()"
    assert ran(project, "-c", threads)[0] == "16\n"
    fork = "import halves, os; os.fork() or (print(halves.half(8), flush=True), os._exit(0)); os.wait()"
    folder = project / "home" / FOLDER
    assert run(sys.executable, "-c", fork, folder=folder, more=str(project)).stdout == "16\n"
    found = [EventReader(str(file), KEY).read(is_last=True) for file in folder.glob("*.jsonl")]
    assert sum(map(hits, found)) == 2
    assert all(isinstance(one[0], Began) for one in found)


def test_an_exception_that_nobody_catches_is_told(project: Path) -> None:
    with pytest.raises(subprocess.CalledProcessError) as failed:
        ran(project, "-c", "import halves; raise ValueError('no half')")
    assert failed.value.stderr.count("ValueError: no half") == 1
    (file,) = (project / "home" / FOLDER).glob("*.jsonl")
    events = EventReader(str(file), KEY).read(is_last=True)
    (raised,) = (one for one in events if isinstance(one, Raised))
    assert raised.text == "ValueError: no half"


def test_a_signal_to_another_process_is_told(project: Path) -> None:
    _, events = ran(project, "-c", "import halves, os; os.kill(os.getppid(), 0)")
    assert Signalled in kinds(events)


def test_an_end_without_clearing_up_is_an_end(project: Path) -> None:
    _, events = ran(project, "-c", "import halves, os; os._exit(0)")
    assert kinds(events) == [Began, SessionEnd]


def test_a_file_that_has_changed_is_not_taken_for_the_mutant(project: Path) -> None:
    (project / "halves.py").write_text(PROGRAM + "\n", encoding="utf-8")
    printed, events = ran(project, "-c", "import halves; print(halves.half(8))")
    assert printed == "4.0\n"
    assert "NotInstrumented" in [one.__name__ for one in kinds(events)]
    assert PlacesReached not in kinds(events)
