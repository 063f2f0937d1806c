"""A campaign under way: what is asked, what is known of the original, who runs tasks, and who is told.

It is made once the baseline is taken, and goes as one to all that give mutants their outcomes.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.baseline.site_names import Sources
from mutabot.campaign.workers.executor import Executor

from .evidence import Evidence
from .request import Progress, Request


@dataclass(frozen=True)
class Campaign:
    """One campaign.

    Attributes:
        request: what is asked.
        baseline: what is known of the original. It grows by what later runs of the original tell, and by
            its own methods alone.
        executor: runs tasks.
        progress: is told what is going on.
        evidence: what is recorded; None if nothing is.
        proven: controls that have ended as they must, so that they need not be run again.
        sources: names the sites that workers report.
    """

    request: Request
    baseline: Baseline
    executor: Executor
    progress: Progress
    evidence: Evidence | None = None
    proven: set[object] = field(default_factory=set)
    sources: Sources = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "sources", Sources(self.request.root))
