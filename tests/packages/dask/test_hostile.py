"""What a worker sends runs nothing on the controller, and costs nobody else an outcome."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from mutabot.cli.app import main
from mutabot.errors import UsageError
from mutabot.model import Verdict
from mutabot_dask import guard, worker_side
from mutabot_dask.link import Link, WorkerReply, one_line
from tests.campaign.project import outcomes

from .clusters import cluster, strange_worker, until, write
from .hostile import ATTACKS, CODE, FORGER


@pytest.fixture(scope="module")
def link(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Link]:
    """A connection to a cluster with a hostile worker."""
    folder = tmp_path_factory.mktemp("dask")
    with cluster(folder, 0) as settings, strange_worker(settings, folder, CODE) as process:
        try:
            there = Link(settings, settings.address)
            assert until(lambda: there.workers, 60)
            yield there
            there.close()
        finally:
            process.kill()


def ask(link: Link, *given: str) -> WorkerReply:
    (worker,) = link.workers
    number = link.ask(worker, worker_side.introduce, *given)
    reply = link.replies.get(timeout=60)
    assert reply.asked == number
    return reply


def ran_here(file: Path) -> bool:
    return file.exists() and str(os.getpid()) in file.read_text().split()


@pytest.mark.whole
@pytest.mark.parametrize("attack", ATTACKS)
def test_nothing_that_a_worker_sends_is_unpickled(attack: str, link: Link, tmp_path: Path) -> None:
    reply = ask(link, attack, str(tmp_path / "ran"))
    assert (reply.data, reply.is_foreign) == ((b"{}", False) if attack == "as_warning" else (None, True))
    assert ask(link, "as_bytes", "").data == b"{}"  # others are still heard
    assert not ran_here(tmp_path / "ran")


def test_dask_in_which_nothing_can_be_closed_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr("distributed.client.clean_exception")
    with pytest.raises(UsageError, match=r"no distributed\.client\.clean_exception"):
        guard.install()


def test_what_a_worker_says_does_nothing_to_a_terminal() -> None:
    assert one_line("\x1b[2Jgone\n\ud800" + "x" * 5000).startswith("�[2Jgone��xxx")
    assert len(one_line("x" * 5000)) == 1000


@pytest.mark.whole
def test_forged_outcomes_are_an_error_of_that_unit_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The only worker is left out then, and the campaign ends here."""
    tests = """
    from mission import run
    from robot import Arm

    def test_run():
        arm = Arm()
        run(arm)
        assert abs(arm.x - 0.4) < 0.01
    """
    mission = "def run(arm):\n    arm.move_by(0.5)\n    arm.move_by(-0.1)\n"
    project = write(tmp_path / "project", mission=mission, tests=tests)
    words = ["-C", str(project), "run", "--engine", "replay", "--only", "reverse", "--only", "skip"]
    with cluster(tmp_path / "dask", 0) as there, strange_worker(there, tmp_path, FORGER) as process:
        try:
            files = [f"-ocluster.{name}={getattr(there, name)}" for name in ("ca", "cert", "key")]
            code = main([*words, "--rounds", "1", "--cluster", there.address, *files])
        finally:
            process.kill()
    found = outcomes(project / ".mutabot" / "journal.sqlite")
    (forged,) = (outcome for outcome in found if outcome.verdict is Verdict.ERROR)
    assert "does not fit" in str(forged.message)
    assert [outcome.verdict for outcome in found if outcome is not forged] == [Verdict.KILLED] * 3
    told = capsys.readouterr().err
    assert told.count("is not used: its answer does not fit") == 1
    assert told.count("the campaign goes on on this machine") == 1
    assert code == 4, told  # outcomes are missing
