"""One unit on a worker."""

from __future__ import annotations

from pathlib import Path

from mutabot.execution.task import Task
from mutabot.model import Vocabulary
from mutabot.model.job import Job
from mutabot_dask.unit import SharedData, UnitAnswer, WorkUnit
from mutabot_dask.worker_side import WorkerSession


def test_what_is_wrong_with_a_workers_folder_names_it_as_it_is_there(tmp_path: Path) -> None:
    ground = SharedData("digest", "/of/the/controller", "", (), {})
    session = WorkerSession(tmp_path / "gone", ground)
    job = Job(ground.root, ("mission.py",), (), Vocabulary(()), seed=1, round=0)
    unit = WorkUnit(ground, Task(None, job), "ticket")
    answer = UnitAnswer.of(session.answer(unit, lambda: None), unit)
    assert answer.is_unfit
    assert answer.fault == f"cannot write to {tmp_path}/gone/.mutabot: No such file or directory"
