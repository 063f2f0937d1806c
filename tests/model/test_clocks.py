"""Clocks that a test cannot take away."""

from __future__ import annotations

import datetime
import subprocess
import sys
import time
from typing import Any

import pytest

from mutabot.model import clocks

#: what libraries that pretend another time do: each name in each module that means a clock means theirs
EVERYWHERE = """
import sys, time
from mutabot.model import clocks, process_time
from mutabot.evidence import recorder
import mutabot.runtime.test_hooks, mutabot.runtime.observation.probes
names = ("time", "monotonic", "perf_counter", "process_time", "thread_time", "sleep", "clock_gettime")
real = {id(getattr(time, name)): name for name in names}
def fake(*_): return -1.5e9
before = clocks.monotonic(), clocks.process_time()
for module in list(sys.modules.values()):
    for name, value in list(vars(module).items()):
        if id(value) in real:
            setattr(module, name, fake)
assert time.monotonic() == -1.5e9
runtime = mutabot.runtime.test_hooks, mutabot.runtime.observation.probes
for module in (clocks, process_time, recorder, *runtime):
    assert 0.0 <= module.monotonic() - before[0] < 600.0, module
assert 0.0 <= mutabot.runtime.test_hooks.process_time() - before[1] < 600.0
clocks.sleep(0.0)
"""

#: what the same libraries do first: they ask every module for every attribute that it lists
EVERY_ATTRIBUTE = """
import sys
import mutabot.api.faults, mutabot.api.processes, mutabot.api.reports, mutabot.api.values
import mutabot.runtime.session_hooks
before = set(sys.modules)
for module in list(sys.modules.values()):
    if module.__name__.startswith("mutabot"):
        for name in dir(module):
            getattr(module, name)
assert set(sys.modules) == before, sorted(set(sys.modules) - before)
"""


def test_clocks_go_on_while_a_test_replaces_those_of_the_modules(monkeypatch: pytest.MonkeyPatch) -> None:
    class Never(datetime.datetime):
        @classmethod
        def now(cls, tz: Any = None) -> Any:
            raise AssertionError("nobody is to ask")

    before = clocks.monotonic(), clocks.process_time(), clocks.thread_time()
    for name in ("time", "monotonic", "perf_counter", "process_time", "thread_time", "sleep"):
        monkeypatch.setattr(time, name, lambda *_: -1.58e9)
    monkeypatch.setattr(datetime, "datetime", Never)
    after = clocks.monotonic(), clocks.process_time(), clocks.thread_time()
    assert all(0.0 <= late - early < 600.0 for early, late in zip(before, after, strict=True))
    clocks.sleep(0.0)


def test_no_module_of_ours_loses_its_clock_to_who_replaces_them_everywhere() -> None:
    subprocess.run([sys.executable, "-c", EVERYWHERE], check=True, timeout=300)


def test_to_ask_our_modules_for_their_attributes_loads_no_other_module() -> None:
    subprocess.run([sys.executable, "-c", EVERY_ATTRIBUTE], check=True, timeout=300)


def test_the_clock_is_that_of_the_system() -> None:
    assert abs(clocks.monotonic() - time.monotonic()) < 600.0


@pytest.mark.parametrize("library", ["freezegun", "time_machine"])
def test_libraries_that_pretend_another_time_do_not_reach_it(library: str) -> None:
    module = pytest.importorskip(library)
    travel = module.freeze_time if library == "freezegun" else module.travel
    before = clocks.monotonic()
    with travel("2001-02-03"):
        assert 0.0 <= clocks.monotonic() - before < 600.0
