"""What share of a campaign's processor time controls and second looks take.

Runs a campaign of the project in the current folder, with the options given, and prints the processor time of
its parts: what begins it (baseline included), its controls, the mutants with them, the second looks, and all.
Time is that of the controller and all processes below it, which Linux tells to a hundredth of a second. Of
controls it is that of their tests, without the start of their processes.

Use: ``cd PROJECT; python …/benchmarks/own_checks.py [options of mutabot run]``, for example ``--fresh -j 1``.
"""

from __future__ import annotations

import os
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from mutabot.campaign import run
from mutabot.campaign.engines import controls
from mutabot.cli.app import main


def spent() -> float:
    """Processor time of this process, of those below it, and of those that they have waited for, s."""
    processes: dict[int, tuple[int, int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # it has ended
            fields = stat.read_text().rpartition(")")[2].split()
            processes[int(stat.parent.name)] = int(fields[1]), sum(map(int, fields[11:15]))
    own = os.getpid()

    def is_below(process: int) -> bool:
        while process in processes and process != own:
            process = processes[process][0]
        return process == own

    ticks = sum(time for process, (_, time) in processes.items() if is_below(process))
    return ticks / os.sysconf("SC_CLK_TCK")


def measure(parts: dict[str, float]) -> None:
    """Let the parts of campaigns be counted."""

    def timed(name: str) -> None:
        part: Callable[..., Any] = getattr(run, name)

        def measured(*given: Any, **named: Any) -> Any:
            before = spent()
            try:
                return part(*given, **named)
            finally:
                parts[name] += spent() - before

        setattr(run, name, measured)

    def counted(owner: Any, name: str) -> None:
        settled: Callable[..., Iterator[Any]] = getattr(owner, name)

        def measured(*given: Any) -> Iterator[Any]:
            parts["controls"] += given[-1].cpu
            return settled(*given)

        setattr(owner, name, measured)

    for name in ("begin", "run_planned", "rerun"):
        timed(name)
    counted(controls, "_settled")  # by replay
    counted(controls.ForkTrust, "take")


if __name__ == "__main__":
    found: dict[str, float] = defaultdict(float)
    measure(found)
    sys.argv[1:1] = ["run"]
    try:
        main()
    finally:
        whole = spent()
        share = (found["controls"] + found["rerun"]) / whole
        print(
            f"beginning {found['begin']:.2f} s, mutants {found['run_planned']:.2f} s, of these controls "
            f"{found['controls']:.2f} s; second looks {found['rerun']:.2f} s; all {whole:.2f} s: "
            f"controls and second looks {share:.1%}",
            file=sys.stderr,
        )
