"""What the nodes of one worker need around them, so that workers do not meet."""

from __future__ import annotations

from mutabot.border.job import Job

from . import _domain, _master
from ._speech import speaks_of


def prepare(job: Job, home: str) -> None:
    """Set up, before anything of the program's runs, what its nodes will find in the environment.

    Args:
        job: the job at hand.
        home: the worker's folder.

    Raises ``_master.MasterError`` if there is to be a master and none comes up.
    """
    if _domain.is_wanted(job):
        _domain.take(home)
    if _master.is_wanted(job):
        _master.start(home)


def prepare_unknown(root: str, home: str) -> None:
    """The same where no vocabulary tells yet what the program uses: its files do.

    Args:
        root: the project's folder.
        home: a folder for what nodes leave.

    Raises ``_master.MasterError`` likewise.
    """
    if speaks_of(root, "rclpy"):
        _domain.take(home)
    if _master.is_spoken_of(root):
        _master.start(home)
