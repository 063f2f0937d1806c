"""A campaign of 10⁵ mutants × 10 rounds on 1 to 1,000 workers, simulated with costs that were measured.

    python benchmarks/cluster_simulation.py measure REPLAY.sqlite FORK.sqlite CONTROLLER.json …
                                                      store the costs of real campaigns in docs/data
    python benchmarks/cluster_simulation.py           simulate, and store what came of it there
    python tools/make_scaling_page.py                 make docs/scaling.md and its picture of that

The program is many copies of the measured one: each copy has its tests, and its mutants are judged by these
alone. Units, their order and their parts are those of the executor on a cluster: replay has a unit for each
mutant and round; of a fork parent, each worker gets ``PARTS`` parts, none with fewer than ``LEAST`` mutants,
mutants of the same tests together; the longest unit, by the baseline's times, goes first. A worker has one
unit at a time; answers are judged by one controller, one after the other, and a worker waits for its next
unit until the controller has come to its answer.

What is drawn at random is drawn from a seed: the cost of each mutant from the measured ones, how much longer
or shorter a unit takes than expected from equal runs that were measured, and failures of workers.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import random
import sys
from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import simpy

from mutabot.journal.reader import JournalReader
from mutabot.journal.records import DRAWING

DATA = Path(__file__).with_name("scaling.json")
MUTANTS, ROUNDS = 100_000, 10
WORKERS = (1, 10, 100, 300, 1000)
#: as the engines cut a fork parent: parts for each worker, and mutants of a part at least
PARTS, LEAST = 16, 10
#: measured with distributed 2026.8.0 on two cores, s: what a unit costs beside its session on the worker, in
#: the library, and of the scheduler and its client; what a worker takes to begin; what a bundle of 5 MB takes
SHELL, LIBRARY, SCHEDULED, BEGIN, BUNDLE = 0.023, 0.005, 0.003, 4.0, 0.2
#: assumed, for no campaign has been long enough to measure it: s of work after which a worker dies once
LIFE = 24 * 3600.0
#: s until the unit of a dead worker runs again
NOTICED = 5.0
SEED = 14


@dataclass(frozen=True)
class Costs:
    """What was measured.

    Attributes:
        mutants: of the measured program.
        suite: s of one run of its tests.
        replay: s of each session of replay.
        fork: s of each fork, and of what belongs to it alone.
        spread: how much longer or shorter equal runs of a test took than their mean, as factors.
        controller: s of the controller for an outcome, by engine.
    """

    mutants: int
    suite: float
    replay: tuple[float, ...]
    fork: tuple[float, ...]
    spread: tuple[float, ...]
    controller: dict[str, float]

    @classmethod
    def load(cls, path: Path = DATA) -> Costs:
        """Those that are stored."""
        data = json.loads(path.read_text(encoding="utf-8"))["costs"]
        return cls(
            data["mutants"], data["suite"], tuple(data["replay"]), tuple(data["fork"]),
            tuple(data["spread"]), data["controller"],
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Unit:
    """What a worker gets.

    Attributes:
        fork_parent: s of the original's own run in it.
        mutants: s of its mutants.
        outcomes: how many these are.
    """

    fork_parent: float
    mutants: float
    outcomes: int

    @property
    def seconds(self) -> float:
        """What it is expected to take."""
        return self.fork_parent + self.mutants


@dataclass(frozen=True, slots=True)
class Way:
    """How a campaign is run.

    Attributes:
        engine: ``replay`` or ``fork``.
        parts: of a fork parent, for each worker; 0 for fork parents that are not cut.
        longest_first: whether units are sorted.
        spread: whether equal units take different times.
        failures: whether workers die.
    """

    engine: str
    parts: int = PARTS
    longest_first: bool = True
    spread: bool = True
    failures: bool = True


@dataclass
class Run:
    """What came of a simulated campaign, s of all workers together, but for ``ended``.

    Attributes:
        workers: how many.
        units: how many.
        ended: s from the start to the last outcome.
        begun, useful, originals, shipped, waited, lost, idle: beginning, mutants, original's own runs, units
            on their way, waiting for the controller, work of workers that died, and nothing to do any more.
        controller: s that the controller was at work.
    """

    workers: int
    units: int = 0
    ended: float = 0.0
    begun: float = 0.0
    useful: float = 0.0
    originals: float = 0.0
    shipped: float = 0.0
    waited: float = 0.0
    lost: float = 0.0
    idle: float = 0.0
    controller: float = 0.0
    last: list[float] = field(default_factory=list)

    def shares(self) -> dict[str, float]:
        """Parts of the time of all workers."""
        whole = self.workers * self.ended
        names = ("begun", "useful", "originals", "shipped", "waited", "lost", "idle")
        return {name: round(getattr(self, name) / whole, 5) for name in names}


def units_of(costs: Costs, way: Way, workers: int, mutants: int = MUTANTS) -> list[Unit]:
    """The units of a campaign, in the order in which they are given away."""
    chance = random.Random(f"{SEED}:{way.engine}")
    if way.engine == "replay":
        units = [Unit(0.0, seconds, 1) for seconds in chance.choices(costs.replay, k=mutants * ROUNDS)]
    else:
        drawn = chance.choices(costs.fork, k=mutants)
        units = [unit for _ in range(ROUNDS) for unit in _cut(costs, drawn, way, workers)]
    return sorted(units, key=lambda unit: -unit.seconds) if way.longest_first else units


def _cut(costs: Costs, drawn: Sequence[float], way: Way, workers: int) -> Iterator[Unit]:
    """The fork parent of a round in parts: as ``campaign.engines.fork_parent`` cuts it."""
    count = math.ceil(way.parts * workers / ROUNDS) if workers > 1 and way.parts else 1
    count = max(1, min(count, len(drawn) // LEAST))
    bounds = [round(len(drawn) * number / count) for number in range(count + 1)]
    for first, last in itertools.pairwise(bounds):
        # the tests of all copies of the program that have mutants in it
        copies = math.ceil(last / costs.mutants) - first // costs.mutants
        yield Unit(copies * costs.suite, sum(drawn[first:last]), last - first)


def simulate(costs: Costs, way: Way, workers: int, mutants: int = MUTANTS) -> Run:
    """One campaign after its baseline."""
    units = units_of(costs, way, workers, mutants)
    run = Run(workers, len(units))
    world = simpy.Environment()
    waiting, again = iter(units), list[Unit]()
    chance = random.Random(f"{SEED}:{workers}")
    free = 0.0  # when the controller has come to the end of what it has been given

    def judged(outcomes: int) -> float:
        """Seconds until the controller has judged an answer that comes now."""
        nonlocal free
        work = SCHEDULED + outcomes * costs.controller[way.engine]
        run.controller += work
        free = max(free, world.now) + work
        return free - world.now

    def due() -> Unit | None:
        return again.pop() if again else next(waiting, None)

    def worker() -> Generator[simpy.Event, Any, Any]:
        yield world.timeout(BEGIN + BUNDLE)
        run.begun += BEGIN + BUNDLE
        while (unit := due()) is not None:
            factor = _factor(costs, way, unit, chance)
            takes = unit.seconds * factor
            if way.failures and chance.random() < takes / LIFE:
                spent = takes * chance.random() + NOTICED + BEGIN
                run.lost += spent
                again.append(unit)
                yield world.timeout(spent)
                continue
            yield world.timeout(SHELL + LIBRARY + takes)
            run.shipped += SHELL + LIBRARY
            run.useful += unit.mutants * factor
            run.originals += unit.fork_parent * factor
            wait = judged(unit.outcomes)
            run.waited += wait
            yield world.timeout(wait)
        run.last.append(world.now)

    for _ in range(workers):
        world.process(worker())
    world.run()
    run.ended = max(run.last)
    run.idle = sum(run.ended - last for last in run.last)
    return run


def _factor(costs: Costs, way: Way, unit: Unit, chance: random.Random) -> float:
    """How much longer than expected a unit takes; what is made of many runs is closer to its mean."""
    if not way.spread:
        return 1.0
    return 1.0 + (chance.choice(costs.spread) - 1.0) / math.sqrt(unit.outcomes)


def alone(costs: Costs, engine: str, mutants: int = MUTANTS) -> float:
    """Seconds of one worker without chance: what all others are compared with."""
    units = units_of(costs, Way(engine), 1, mutants)
    own = len(units) * (SHELL + LIBRARY + SCHEDULED) + sum(unit.seconds for unit in units)
    return BEGIN + BUNDLE + own + costs.controller[engine] * sum(unit.outcomes for unit in units)


def baseline_seconds(costs: Costs, places: int, runs: int, mutants: int = MUTANTS) -> float:
    """What the baseline takes on one machine with so many places, before anything is given away."""
    suite = mutants / costs.mutants * costs.suite
    return math.ceil(runs * ROUNDS / places) * suite


def study(costs: Costs, mutants: int = MUTANTS, workers: Sequence[int] = WORKERS) -> dict[str, Any]:
    """All numbers of the page."""
    found: dict[str, Any] = {"mutants": mutants, "rounds": ROUNDS}
    for engine in ("replay", "fork"):
        alone_seconds = alone(costs, engine, mutants)
        rows = []
        for number in workers:
            run = simulate(costs, Way(engine), number, mutants)
            even = simulate(costs, Way(engine, spread=False, failures=False), number, mutants)
            stragglers = max(0.0, run.idle - even.idle) / (number * run.ended)
            rows.append({
                "workers": number,
                "hours": round(run.ended / 3600, 3),
                "speed_up": round(alone_seconds / run.ended, 2),
                "efficiency": round(alone_seconds / run.ended / number, 4),
                "units": run.units,
                "controller": round(run.controller / run.ended, 4),
                "shares": run.shares() | {
                    "stragglers": round(stragglers, 5),
                    "last": round(run.idle / (number * run.ended) - stragglers, 5),
                },
            })  # fmt: skip
        found[engine] = rows
    ways = {
        "not cut: one for each round": Way("fork", parts=0),
        "1 part for each worker": Way("fork", parts=1),
        "2 parts": Way("fork", parts=2),
        "4 parts": Way("fork", parts=4),
        "16 parts": Way("fork", parts=16),
        "16 parts, in any order": Way("fork", parts=16, longest_first=False),
        "64 parts": Way("fork", parts=64),
    }
    alone_seconds = alone(costs, "fork", mutants)
    found["sizes"] = []
    for name, way in ways.items():
        run = simulate(costs, way, 100, mutants)
        found["sizes"].append({
            "name": name,
            "units": run.units,
            "efficiency": round(alone_seconds / run.ended / 100, 4),
            "shares": run.shares(),
        })  # fmt: skip
    found["baseline"] = [
        {
            "places": places,
            "hours": round(baseline_seconds(costs, places, 2, mutants) / 3600, 2),
        }
        for places in (2, 16, 20)
    ]
    return found


def measure(replay: Path, fork: Path, controllers: Sequence[Path], how: str) -> dict[str, Any]:
    """The costs in the journals of real campaigns, and in what ``benchmarks/controller.py --json`` prints."""
    with JournalReader.open(replay) as journal:
        sessions = [outcome.wall for outcome in journal.outcomes() if outcome.tests]
        tests = journal.tests()
        meta = journal.meta()
    with JournalReader.open(fork) as journal:
        forks = [outcome.wall for outcome in journal.outcomes() if outcome.tests and outcome.engine == "fork"]
    walls: dict[tuple[int, str], list[float]] = {}
    for baseline_test in tests:
        walls.setdefault((baseline_test.round, baseline_test.test.test), []).append(baseline_test.test.wall)
    spread = [wall / (sum(each) / len(each)) for each in walls.values() if len(each) > 1 for wall in each]
    rounds = len({journal_test.round for journal_test in tests})
    controller = {}
    for path in controllers:
        data = json.loads(path.read_text(encoding="utf-8"))
        controller[data["engine"]] = data["cpu_ms"] / 1e3
    return {
        "made_by": how,
        "mutabot": meta["mutabot"],
        "costs": {
            "mutants": meta[DRAWING].selected if DRAWING in meta else len(Counter(sessions)),
            "suite": round(sum(sum(each) / len(each) for each in walls.values()) / rounds, 3),
            "replay": [round(session, 3) for session in sorted(sessions)],
            "fork": [round(seconds, 4) for seconds in sorted(forks)],
            "spread": [round(seconds, 4) for seconds in sorted(spread)],
            "controller": controller,
        },
    }


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", nargs="*", help="measure, and files")
    parser.add_argument("--mutants", type=int, default=MUTANTS)
    parser.add_argument("--how", default="", help="with measure: the commands that made the files")
    given = parser.parse_args()
    if given.what[:1] == ["measure"]:
        replay, fork, *controllers = map(Path, given.what[1:])
        found = measure(replay, fork, controllers, given.how)
        DATA.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        return 0
    found = study(Costs.load(), given.mutants)
    if given.mutants == MUTANTS:
        data = json.loads(DATA.read_text(encoding="utf-8"))
        DATA.write_text(json.dumps({**data, "found": found}, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(found, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
