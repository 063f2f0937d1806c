"""The job of the test process that a process lives below."""

from __future__ import annotations

import json
import os

from mutabot.border.codec import from_data
from mutabot.border.job import Job


def job_of(folder: str) -> Job:
    """The job, from the home in which the folder of the processes lies."""
    with open(os.path.join(os.path.dirname(folder), "job.json"), encoding="utf-8") as file:
        job: Job = from_data(Job, json.load(file))
    return job
