"""The controller of a campaign of a hundred thousand mutants: is its memory flat, and what does it compute?

A real campaign is run first, in processes, and what its workers say is written down. Then the same mutants
are planned again and again under other names, and the real controller (engines, judge, keys, recordings,
journal) runs them all against an executor that takes each job as a worker would get it and answers, line by
line, what the real worker had said. So nothing is measured but the controller itself.

Its processor time is held against what so many workers are at work: the time by the clock that the real
sessions took, divided among 100 workers. Promises:

- the controller takes less than a tenth of one core for 100 workers;
- from a tenth of the outcomes to the end of the last mutant, its memory grows by less than 5 %.

Use: ``python benchmarks/controller.py [--mutants 100000] [--engine replay|fork] [--example paper]
[--sample 24] [--json]``. The exit code is 1 if a promise is broken.
"""

from __future__ import annotations

import argparse
import cProfile
import json
import os
import pickle
import pstats
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.engine import run_trials
from mutabot.campaign.evidence import CampaignEvidence, recorded
from mutabot.campaign.plan import make_plan
from mutabot.campaign.preparation import begin, open_executor, selected
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.reuse.keys import Dependencies, OutcomeWriter
from mutabot.campaign.reuse.original import OriginalRuns
from mutabot.campaign.reuse.snapshot import State
from mutabot.cli.request import request_of
from mutabot.execution.task import Executor, Result, Task
from mutabot.journal.journal import Journal
from mutabot.journal.records import BaselineTest
from mutabot.model import Mutant
from mutabot.model.events import (
    Event,
    ForkDied,
    ForkTestEnd,
    TokensHeld,
    Undiverged,
    event_from_data,
    event_to_data,
)
from mutabot.model.job import Forking

EXAMPLES = Path(__file__).parent.parent / "examples"
WORKERS = 100
#: mutants of a fork parent: a part, as executors on several machines have them
PART = 500
LOOKS = 20
SHARE, LARGER = 0.1, 1.05
#: between the name of a mutant and the number of its copy
MARK = "~"


@dataclass
class Told:
    """What a worker said: its lines as text, and what else its result has."""

    lines: list[str] = field(default_factory=list)
    wall: float = 0.0
    exit_code: int = 0


@dataclass
class Recorder:
    """An executor that writes down what another one's workers say, by mutant and round, or by round."""

    inner: Executor
    told: dict[Any, Told] = field(default_factory=dict)
    spread: int = 1
    remarks: list[str] = field(default_factory=list)

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        """What the other one says."""
        for event in self.inner.events(tasks):
            task = event.task if isinstance(event, Result) else event[0]
            told = self.told.setdefault(_key(task), Told())
            if isinstance(event, Result):
                told.wall, told.exit_code = event.wall, event.exit_code
            else:
                told.lines.append(json.dumps(event_to_data(event[1])))
            yield event

    def run(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """The same without lines."""
        return (event for event in self.events(tasks) if isinstance(event, Result))

    def rest(self, is_awaited: Callable[[], bool], seconds: float) -> Iterator[Result | tuple[Task, Event]]:
        """What the other one says after an interruption: nobody interrupts what is recorded."""
        return self.inner.rest(is_awaited, seconds)

    def apart(self) -> AbstractContextManager[Executor]:
        """That of the other one."""
        return self.inner.apart()


@dataclass
class Player:
    """An executor without workers: it answers what was written down."""

    told: dict[Any, Told]
    sent: int = 0
    work: float = 0.0
    spread: int = 1
    remarks: list[str] = field(default_factory=list)

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        """What the workers of these jobs would say."""
        for task in tasks:
            self.sent += len(pickle.dumps(task.job))
            told = self.told[_key(task)]
            result = Result(task, exit_code=told.exit_code, wall=told.wall)
            forking = task.job.forking
            texts = told.lines if forking is None else _forked(told.lines, forking)
            for text in texts:
                line = event_from_data(json.loads(text))
                result.take(line)
                yield task, line
            if forking is None:
                self.work += told.wall
            yield result

    def run(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """The same without lines."""
        return (event for event in self.events(tasks) if isinstance(event, Result))

    def rest(self, is_awaited: Callable[[], bool], seconds: float) -> Iterator[Result | tuple[Task, Event]]:
        """Nothing is left to wait for: what was written down has been told."""
        return iter(())

    def apart(self) -> AbstractContextManager[Executor]:
        """Nothing here needs one."""
        raise NotImplementedError


def _key(task: Task) -> Any:
    mutant = task.job.mutant
    if mutant is None:
        return task.job.round
    return _original(mutant.id), task.job.round


def _original(mutant: str) -> str:
    """The name that a copy was made of."""
    return mutant.partition(MARK)[0].removesuffix("=")


def _forked(lines: Iterable[str], forking: Forking) -> Iterator[str]:
    """What a fork parent says of all copies of its mutants."""
    copies: dict[str, list[str]] = {}
    for mutant in forking.mutants:
        copies.setdefault(_original(mutant.id), []).append(mutant.id)
    for text in lines:
        data = json.loads(text)
        kind, mutant = data["type"], data.get("mutant")
        if kind == TokensHeld.__name__:
            continue
        if kind == Undiverged.__name__:
            hits = data["hits"]
            data["hits"] = {copy: hits[name] for name in hits for copy in copies.get(name, ())}
            yield json.dumps(data)
        elif kind in {event.__name__ for event in (ForkDied, ForkTestEnd)} and mutant:
            yield from (json.dumps({**data, "mutant": copy}) for copy in copies.get(mutant, ()))
        else:
            yield text


class Silent(Progress):
    """A progress that counts."""

    def __init__(self, looked: Callable[[int], None] = lambda count: None) -> None:
        self._looked, self._count = looked, 0

    def advance(self, line: str | None = None) -> None:
        """One outcome more."""
        self._count += 1
        self._looked(self._count)


def memory() -> float:
    """Resident memory of this process, MB."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def copies(mutants: list[Mutant], number: int) -> list[Mutant]:
    """So many mutants: these under ever new names."""
    found = []
    for at in range(number):
        mutant = mutants[at % len(mutants)]
        found.append(replace(mutant, number=at + 1, variant=f"{mutant.variant}{MARK}{at}"))
    return found


def measure(given: argparse.Namespace, folder: Path) -> dict[str, Any]:
    """Run everything; the numbers."""
    root = folder / given.example
    shutil.copytree(EXAMPLES / given.example, root, ignore=shutil.ignore_patterns(".*", "__pycache__"))
    request = request_of(
        root, engine=given.engine, rounds=1, family=["robot"], sample=given.sample, evidence=True,
    )  # fmt: skip
    with (
        open_executor(request, Silent()) as opened,
        Journal.prepare(request.journal_path, meta={"rounds": 1}) as journal,
        recorded(request, Silent()) as evidence,
    ):
        recorder = Recorder(opened)
        with OriginalRuns(request, None, Silent()) as original:
            campaign, results = begin(request, recorder, Silent(), evidence, original=original)
        plan = selected(campaign, make_plan(campaign.baseline, request.project))
        for result in results:
            number, repetition = result.task.key
            journal.add_tests(BaselineTest.of(number, repetition, end) for end in result.ends)
        if evidence is not None:
            runs = [(*found_result.task.key, found_result.ends) for found_result in results]
            evidence.begin(runs, plan.mutants)
        state = State.now(request, original.before, original.after, None)
        dependencies = Dependencies(request, campaign.baseline, state, original.installed)
        recorder.told.clear()
        began = time.monotonic()
        run_trials(campaign, [(mutant, 0) for mutant in plan.mutants], OutcomeWriter(journal))
        took = time.monotonic() - began
        by_hand = {(outcome.mutant, outcome.round): outcome.verdict for outcome in journal.outcomes()}
        return _play(
            given, request, campaign, plan.mutants, recorder.told, journal, dependencies, evidence
        ) | {
            "real_mutants": len(plan.mutants),
            "real_seconds": round(took, 1),
            "real_verdicts": len(by_hand),
            "worker_seconds": took * request.jobs / len(plan.mutants),
        }


def _play(
    given: argparse.Namespace, request: Request, campaign: Campaign, mutants: list[Mutant],
    told: dict[Any, Told], journal: Journal, dependencies: Dependencies, evidence: CampaignEvidence | None,
) -> dict[str, Any]:  # fmt: skip
    many = copies(mutants, given.mutants)
    planned = campaign.baseline.faults.by_id
    for at, mutant in enumerate(many):
        planned[mutant.id] = replace(planned[mutants[at % len(mutants)].id], mutant=mutant)
    journal.set_plan(many, ())
    looks: list[tuple[int, float, float]] = []
    step = max(1, given.mutants // LOOKS)

    def look(count: int) -> None:
        if count == 1 or count % step == 0:
            looks.append((count, time.process_time(), memory()))

    player = Player(told)
    playing = Campaign(request, campaign.baseline, player, Silent(look), evidence, campaign.proven)
    sink = OutcomeWriter(journal, dependencies, many)
    profile = cProfile.Profile() if given.profile else None
    if profile is not None:
        profile.enable()
    began = time.process_time()
    size = PART if given.engine == "fork" else len(many)
    for start in range(0, len(many), size):
        run_trials(playing, [(candidate, 0) for candidate in many[start : start + size]], sink)
    cpu = time.process_time() - began
    if profile is not None:
        profile.disable()
        pstats.Stats(profile, stream=sys.stderr).sort_stats("tottime").print_stats(35)
    tenth = next(measured for measured in looks if measured[0] >= given.mutants / 10)
    return {
        "mutants": len(many),
        "cpu_seconds": round(cpu, 1),
        "cpu_ms": round(1e3 * cpu / len(many), 3),
        "cpu_ms_last": round(1e3 * (looks[-1][1] - looks[-3][1]) / (looks[-1][0] - looks[-3][0]), 3),
        "sent_kb": round(player.sent / 1e3 / len(many), 2),
        "memory_mb": [(count, round(mb, 1)) for count, _, mb in looks],
        "larger": round(looks[-1][2] / tenth[2], 3),
    }


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--mutants", type=int, default=100_000)
    parser.add_argument("--engine", default="replay", choices=("replay", "fork"))
    parser.add_argument("--example", default="paper")
    parser.add_argument("--sample", default="24", help="how many mutants are really run")
    parser.add_argument("--profile", action="store_true", help="show where the time goes")
    parser.add_argument("--json", action="store_true", help="print JSON instead of text")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        found = measure(given, Path(name).resolve())
    found["engine"] = given.engine
    found["share"] = round(found["cpu_ms"] / 1e3 / (found["worker_seconds"] / WORKERS), 3)
    wrong = []
    if found["share"] >= SHARE:
        wrong.append(f"the controller takes {found['share']:.0%} of a core for {WORKERS} workers")
    if found["larger"] >= LARGER:
        wrong.append("the controller's memory grows")
    if given.json:
        print(json.dumps({**found, "broken": wrong}, indent=2))
    else:
        show(given, found)
        print("\n".join(f"BROKEN: {text}" for text in wrong) or "all promises are kept")
    return 1 if wrong else 0


def show(given: argparse.Namespace, found: dict[str, Any]) -> None:
    """Print the numbers."""
    print(
        f"{given.example}, {given.engine}: {found['real_mutants']} mutants in {found['real_seconds']} s, "
        f"{found['worker_seconds']:.3f} s of a worker each"
    )
    print(
        f"{found['mutants']} mutants: {found['cpu_seconds']} s of the controller, {found['cpu_ms']} ms each, "
        f"{found['sent_kb']} kB sent for each"
    )
    print(f"for {WORKERS} workers that is {found['share']:.1%} of a core")
    print("memory, MB: " + ", ".join(f"{mb} at {count}" for count, mb in found["memory_mb"]))
    print(f"  from a tenth of the outcomes to the last: ratio {found['larger']}")


if __name__ == "__main__":
    sys.exit(main())
