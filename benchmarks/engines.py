"""The engines side by side on the examples: what sharing prefixes is worth.

Three ways to run the same mutants, in one go on the same machine:

  fork     fork parent and forks: the prefix is shared up to the site
  replay   a fresh process per mutant and round, with the tests that reach the site
  fresh    a fresh pytest per mutant and round with the whole suite until a test fails, as general tools do it

Our workers spare themselves what a plain pytest does for nothing: where hypothesis is installed, its plugin
imports all of it for a summary at the end. `fresh` does not, for a general tool starts a plain pytest.

The physics bound of a row is the least time in which its steps can be simulated here: steps, divided by the
rate at which the bare engine repeats a run of the example's program on one core while all cores do so,
divided by cores. Efficiency is that bound divided by the wall time. The peak of memory is that of the largest
process. `fork` is the median of three runs.

Usage: python benchmarks/engines.py [--examples paper …] [--engines fork …] [--limit N] [--output FILE]
                                    [--page FILE]
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import json
import multiprocessing
import os
import resource
import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from mutabot.campaign.baseline.taking import take_baseline
from mutabot.campaign.beginning import selected
from mutabot.campaign.campaign import Campaign, MutantRun
from mutabot.campaign.engines.engine import Unhandled, replay, run_forks
from mutabot.campaign.plan import make_plan
from mutabot.campaign.request import Request
from mutabot.config.configuration import load_configuration
from mutabot.config.options import Sample
from mutabot.config.vocabulary import load
from mutabot.execution.workers import Workers
from mutabot.model import Outcome

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES: dict[str, dict[str, Any]] = {
    "paper": {"selection": "published.txt", "rounds": 5},
    "pick_and_place": {"selection": None, "rounds": 1},
    "scales": {"selection": None, "rounds": 1},
    # random samples: with all mutants, fresh would take hours
    "tracking": {"selection": None, "rounds": 1, "sample": "20"},
    "palletising": {"selection": None, "rounds": 1, "sample": "10"},
}
HEADINGS = (
    "example", "engine", "mutants × rounds", "wall s", "CPU s", "steps", "per second", "peak MB",
    "efficiency",
)  # fmt: skip
MARK = "<!-- Written by `make bench` (benchmarks/engines.py) from here on. -->"
ENGINES = ("fork", "replay", "fresh")
#: physics steps per simulated second of mutabot_cell
STEPS_PER_SECOND = 500


@dataclass
class Row:
    """One line of the table."""

    example: str
    engine: str
    outcomes: int
    wall: float
    cpu: float
    simulated: float
    memory: float
    bound: float | None

    @property
    def data(self) -> dict[str, Any]:
        efficiency = self.bound / self.wall if self.bound is not None else None
        return {**vars(self), "per_second": self.outcomes / self.wall, "efficiency": efficiency}


class Silent:
    """A progress that says nothing."""

    def stage(self, text: str, total: int | None = None) -> None:
        """Ignore it."""

    def advance(self, line: str | None = None) -> None:
        """Ignore it."""

    def note(self, text: str) -> None:
        """Ignore it."""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--examples", nargs="+", default=list(EXAMPLES), choices=list(EXAMPLES))
    parser.add_argument("--engines", nargs="+", default=list(ENGINES), choices=ENGINES)
    parser.add_argument("--limit", type=int, default=None, help="mutants per example at most")
    parser.add_argument("--output", type=Path, default=None)
    parser.add_argument("--page", type=Path, default=None, help="page whose last part is written anew")
    options = parser.parse_args()
    cores = len(os.sched_getaffinity(0))
    rates = {example: raw_step_rate(example, cores) for example in options.examples if example in PROGRAMS}
    rows = [
        typical(example, engine, options.limit, rates.get(example))
        for example in options.examples
        for engine in options.engines
    ]
    show(rows, rates)
    if options.page is not None:
        write_page(options.page, rows, rates)
    if options.output is not None:
        data = {"raw_steps_per_second": rates, "rows": [row.data for row in rows]}
        options.output.write_text(json.dumps(data, indent=1), encoding="utf-8")


def write_page(page: Path, rows: list[Row], rates: dict[str, float]) -> None:
    """Put the table at the end of a page, after the mark."""
    kept = page.read_text(encoding="utf-8").partition(MARK)[0]
    lines = [
        f"{kept}{MARK}",
        "",
        f"On {len(os.sched_getaffinity(0))} cores, in one run; {bare(rates)}.",
        "",
        f"| {' | '.join(HEADINGS)} |",
        f"|---|---|{'---:|' * (len(HEADINGS) - 2)}",
        *(f"| {' | '.join(cells(row))} |" for row in rows),
        "",
        *ratios(rows),
    ]
    page.write_text("\n".join(lines) + "\n", encoding="utf-8")


def bare(rates: dict[str, float]) -> str:
    """The rates of the bare engine in words."""
    found = ", ".join(f"{example} {rate:,.0f}" for example, rate in rates.items())
    return f"bare physics, steps/s on each: {found}"


def ratios(rows: list[Row]) -> Iterator[str]:
    """How many times faster forking is than the other ways."""
    walls = {(row.example, row.engine): row.wall for row in rows}
    for example in dict.fromkeys(row.example for row in rows):
        if (example, "fork") in walls:
            others = [
                f"{walls[example, engine] / walls[example, 'fork']:.1f} times as fast as {engine}"
                for engine in ENGINES[1:]
                if (example, engine) in walls
            ]
            if others:
                yield f"- {example}: fork is {', '.join(others)}."


def typical(example: str, engine: str, limit: int | None, rate: float | None) -> Row:
    """One row; of what takes seconds the median of three, since a busy moment would spoil it."""
    times = 3 if engine == "fork" else 1
    rows = [apart(measure, example, engine, limit, rate) for _ in range(times)]
    return sorted(rows, key=lambda row: row.wall)[times // 2]


def apart(function: Callable[..., Row], *arguments: Any) -> Row:
    """Call it in a process of its own, so that memory is its own as well."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(function, arguments)


def measure(example: str, engine: str, limit: int | None, rate: float | None) -> Row:
    """Run one example with one engine in a copy, baseline and start-up included."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / example
        shutil.copytree(ROOT / "examples" / example, folder, ignore=shutil.ignore_patterns(".mutabot"))
        before, started = cpu_seconds(), time.monotonic()
        request = request_for(folder, **EXAMPLES[example])
        if engine == "fresh":
            request = as_plain_pytest(request)
        with Workers(request.root, request.arguments, request.jobs) as workers:
            shared = engine == "fork"
            baseline, results = take_baseline(
                request, workers, Silent(), repetitions=1 if shared else 2, may_share=shared
            )
            campaign = Campaign(request, baseline, workers, Silent())
            mutants = selected(campaign, make_plan(baseline, request.project)).mutants[:limit]
            trials = [(mutant, round) for round in range(request.rounds) for mutant in mutants]
            outcomes = list(run_pairs(engine, campaign, trials))
        wall, cpu = time.monotonic() - started, cpu_seconds() - before
    originals = sum(end.simulated or 0.0 for result in results for end in result.ends)
    if shared:
        originals *= 2  # the fork parents run the same again
    simulated = originals + sum((one.simulated or 0.0) - (one.shared or 0.0) for one in outcomes)
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    bound = None if rate is None else simulated * STEPS_PER_SECOND / rate / request.jobs
    return Row(example, engine, len(outcomes), wall, cpu, simulated, peak, bound)


def run_pairs(engine: str, campaign: Campaign, trials: list[MutantRun]) -> Iterator[Outcome]:
    """All outcomes; what a fork parent could not do is replayed, as in a campaign."""
    if engine == "fork":
        left = Unhandled()
        yield from run_forks(campaign, trials, left)
        yield from replay(campaign, left.runs)
        return
    if engine == "fresh":
        baseline = campaign.baseline
        for round, place in baseline.reaching:
            baseline.reaching[round, place] = list(baseline.tests[round])
    yield from replay(campaign, trials)


def request_for(folder: Path, *, selection: str | None, rounds: int, sample: str | None = None) -> Request:
    """The campaign to measure."""
    configuration = load_configuration(folder)
    vocabulary = load(configuration.vocabulary, configuration.root)
    jobs = len(os.sched_getaffinity(0))
    file = folder / selection if selection is not None else None
    drawn = None if sample is None else Sample.parse(sample)
    return Request(configuration, vocabulary, rounds, 1, jobs, selection=file, sample=drawn)


def as_plain_pytest(request: Request) -> Request:
    """The same with what hypothesis's plugin imports in a plain pytest, if it is installed."""
    if importlib.util.find_spec("hypothesis") is None:
        return request
    configuration = request.configuration
    arguments = (*configuration.pytest_args, "-p", "hypothesis")
    return replace(request, configuration=configuration.model_copy(update={"pytest_args": arguments}))


def cpu_seconds() -> float:
    """Processor time of this process and of all that have ended below it, s."""
    own, children = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return own.ru_utime + own.ru_stime + children.ru_utime + children.ru_stime


def raw_step_rate(example: str, cores: int) -> float:
    """Physics steps per second and core of the bare engine, with as many processes as there are cores.

    A recorded run of the example's program is stepped again without control. All cores are busy, as they are
    in a campaign: cores that share something are slower together than one alone.
    """
    with multiprocessing.get_context("spawn").Pool(cores) as pool:
        inputs = pool.apply(recorded_inputs, (example,))
        return statistics.mean(pool.map(step_bare, [inputs] * cores))


def recorded_inputs(example: str) -> list[Any]:
    """Inputs of all servos at every physics step of a run of the example's program."""
    from mutabot_cell import Cell  # noqa: PLC0415  # only this needs it

    sys.path.insert(0, str(ROOT / "examples" / example))
    cell = Cell(1)
    inputs: list[Any] = []
    cell.simulation.after_tick.append(lambda: inputs.extend(cell.simulation.setpoints.copy()))
    PROGRAMS[example](cell)
    return inputs


def run_paper(cell: Any) -> None:
    """The published program."""
    kinova, mission = importlib.import_module("kinova"), importlib.import_module("mission")
    kinova.connect(cell)
    mission.run()


def run_pick_and_place(cell: Any) -> None:
    """The sorting program."""
    importlib.import_module("sorting").run(cell)


PROGRAMS: dict[str, Callable[[Any], None]] = {"paper": run_paper, "pick_and_place": run_pick_and_place}


def step_bare(inputs: list[Any]) -> float:
    """Steps per second of wall clock, the best of several times."""
    import mujoco  # noqa: PLC0415  # only this needs it

    from mutabot_cell import Cell  # noqa: PLC0415

    rates = []
    for _ in range(8):
        again = Cell(1).simulation
        # each reading of an attribute makes a new view, which takes longer than the copying
        model, data, ctrl = again.model, again.data, again.data.ctrl
        started = time.perf_counter()
        for row in inputs:
            ctrl[:] = row
            mujoco.mj_step(model, data)
        rates.append(len(inputs) / (time.perf_counter() - started))
    return max(rates)


def cells(row: Row) -> list[str]:
    """What stands in the columns of a table."""
    data = row.data
    efficiency = "" if data["efficiency"] is None else f"{data['efficiency']:.2f}"
    steps = "" if row.bound is None else f"{row.simulated * STEPS_PER_SECOND:,.0f}"
    return [
        row.example, row.engine, str(row.outcomes), f"{row.wall:.1f}", f"{row.cpu:.1f}", steps,
        f"{data['per_second']:.1f}", f"{row.memory:.0f}", efficiency,
    ]  # fmt: skip


def show(rows: list[Row], rates: dict[str, float]) -> None:
    """Print the table."""
    table = Table(title=bare(rates))
    for heading in HEADINGS:
        table.add_column(heading, justify="left" if heading in ("example", "engine") else "right")
    for row in rows:
        table.add_row(*cells(row))
    console = Console(width=110)
    console.print(table)
    for line in ratios(rows):
        console.print(line)


if __name__ == "__main__":
    main()
