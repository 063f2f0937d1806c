"""The page on scaling is made of its data, and the simulation cuts and orders work as the executors do."""

from __future__ import annotations

import importlib.util
import sys
from dataclasses import replace
from typing import Any

import pytest

import make_scaling_page
import pages
from mutabot.campaign.engines import forks

pytest.importorskip("simpy")


def _simulation() -> Any:
    path = pages.ROOT / "benchmarks" / "cluster_simulation.py"
    spec = importlib.util.spec_from_file_location("cluster_simulation", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


simulation = _simulation()
COSTS = simulation.Costs(100, 3.0, (1.0, 2.0, 4.0), (0.1, 0.2, 0.6), (0.8, 1.0, 1.2), {
    "replay": 0.002, "fork": 0.002,
})  # fmt: skip
EVEN = {"spread": False, "failures": False}


def test_the_page_is_made_of_its_data() -> None:
    assert make_scaling_page.main(["--check"]) == 0


def test_a_fork_parent_is_cut_as_the_engine_cuts_it() -> None:
    assert (forks._LEAST, forks._PARTS) == (simulation.LEAST, simulation.PARTS)


@pytest.mark.parametrize("engine", ["replay", "fork"])
@pytest.mark.parametrize("workers", [1, 7])
def test_no_mutant_is_lost_and_all_time_is_accounted_for(engine: str, workers: int) -> None:
    way = simulation.Way(engine)
    units = simulation.units_of(COSTS, way, workers, 200)
    assert sum(unit.outcomes for unit in units) == 200 * simulation.ROUNDS
    assert [unit.seconds for unit in units] == sorted((unit.seconds for unit in units), reverse=True)
    shares = simulation.simulate(COSTS, way, workers, 200).shares()
    assert sum(shares.values()) == pytest.approx(1.0, abs=1e-3)


def test_without_chance_and_overhead_nothing_is_lost_on_one_worker() -> None:
    way = simulation.Way("replay", **EVEN)
    run = simulation.simulate(COSTS, way, 1, 100)
    assert run.useful == pytest.approx(sum(unit.seconds for unit in simulation.units_of(COSTS, way, 1, 100)))
    assert run.lost == run.idle == 0.0
    assert run.ended == pytest.approx(simulation.alone(COSTS, "replay", 100))


def test_more_workers_are_quicker_and_cost_more() -> None:
    runs = [simulation.simulate(COSTS, simulation.Way("fork", **EVEN), n, 5000) for n in (1, 4, 16)]
    assert [run.ended for run in runs] == sorted((run.ended for run in runs), reverse=True)
    whole = [run.ended * run.workers for run in runs]
    assert whole == sorted(whole)


def test_a_slow_controller_holds_workers_up() -> None:
    slow = replace(COSTS, controller={"replay": 0.5, "fork": 0.5})
    run = simulation.simulate(slow, simulation.Way("replay", **EVEN), 50, 200)
    assert run.controller / run.ended > 0.9
    assert run.shares()["waited"] > 0.5
