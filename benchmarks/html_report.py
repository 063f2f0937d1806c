"""The report of a large campaign: its size, how long it takes to write, and how long to open and to filter.

Use: ``python benchmarks/html_report.py``. The journal and its recordings are made up, through the functions
that campaigns use. Opening and filtering need Playwright (requirements-reports.lock) and a Chromium; without,
they are left out, and that is said.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import shutil
import statistics
import sys
import tempfile
import time
from array import array
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import mutabot
from mutabot.evidence.recording import (
    Block,
    RecordedCall,
    RecordedMoment,
    Recording,
    Track,
    TrackKind,
    to_bytes,
)
from mutabot.journal.journal import Journal
from mutabot.journal.recordings import ORIGINAL, Rank, Recordings
from mutabot.journal.records import BaselineTest
from mutabot.model import By, Check, Looked, Mutant, Outcome, Role, Site, Span, Verdict
from mutabot.model.events import TestEnd
from mutabot.model.world_difference import Apart, Diverged
from mutabot.report.html.folder import Contents, Written, write_folder
from mutabot.report.texts import portable
from mutabot.results.stored import StoredEvidence

FILES, LINES, TESTS = 8, 400, 40
#: s, and moments per s
LENGTH, RATE = 20.0, 10
#: promises: bytes, and ms
LARGEST, SLOWEST_FILTER = 25_000_000, 100.0
#: bytes of recordings that a campaign keeps
KEPT = 400_000_000
OPERATORS = ("skip", "repeat", "reverse", "by-to", "noise", "AOR", "ROR", "UOI")
VERDICTS = (
    (Verdict.KILLED,) * 60 + (Verdict.SURVIVED,) * 25 + (Verdict.REFUSED,) * 8 + (Verdict.NOT_COVERED,) * 7
)


def mutants(count: int) -> Iterator[Mutant]:
    """Made-up mutants, some to a line."""
    for number in range(1, count + 1):
        file, line = number % FILES, 3 + number * 7 % (LINES - 6)
        operator = OPERATORS[number % len(OPERATORS)]
        is_conventional = operator.isupper()
        role = Role.ORACLE if file == FILES - 1 else Role.PROGRAM
        span = Span(f"cell/part_{file}.py", line, 4, line, 34, f"step_{line // 20}")
        yield Mutant(
            number,
            "conventional" if is_conventional else "robot",
            operator,
            Site(span, "arm.move_by", number, role),
            "" if is_conventional else "robot:Arm.move_by",
            None,
            None if operator in ("skip", "repeat") else "dx",
            "",
            f"arm.move_by: {operator} at step {line // 20}, {0.01 * (number % 50):.2f} m",
        )


def recording(seed: int, fault: float | None) -> Recording:
    """A tool that goes between random points and a box that it carries; from the fault on, elsewhere."""
    usual, odd = random.Random(1), random.Random(seed)
    steps = int(LENGTH * RATE)
    times = array("d", (step / RATE for step in range(steps)))
    tool, box = array("f"), array("f")
    start, goal = [0.5, 0.0, 0.5], [0.5, 0.0, 0.5]
    for step in range(steps):
        share = step % 20 / 20
        if step % 20 == 0:
            source = usual if fault is None or step / RATE < fault else odd
            start, goal = (
                goal,
                [source.uniform(-0.6, 0.6), source.uniform(-0.6, 0.6), source.uniform(0.1, 0.8)],
            )
        ease = share * share * (3 - 2 * share)
        at = [first + ease * (second - first) for first, second in zip(start, goal, strict=True)]
        turn = 0.1 * math.sin(step / 15)
        tool.extend((*at, math.cos(turn), 0.0, 0.0, math.sin(turn)))
        box.extend((at[0], at[1], max(0.025, at[2] - 0.1), 1.0, 0.0, 0.0, 0.0))
    calls = []
    for number in range(10):
        source = odd if fault is not None and 2.0 * number > fault else usual
        written = {"dx": round(source.random(), 4), "dy": 0.0}
        place = f"cell/part_0.py:{3 + number}"
        calls.append(
            RecordedCall(2.0 * number, 2.0 * number + 1.9, "robot:Arm.move_by", place, None, written, {})
        )
    return Recording(
        times,
        {
            "tool": Track("tool", TrackKind.POSE, tool),
            "box": Track("box", TrackKind.POSE, box, size=(0.05, 0.05, 0.05)),
        },
        (Block("table", (0.0, 0.0, -0.05), (1.6, 1.6, 0.1)),),
        [RecordedMoment(1.0, "touch", "box, gripper"), RecordedMoment(LENGTH - 1, "part", "box, gripper")],
        calls,
        fault,
        None if fault is None else int(fault // 2),
    )


def build(folder: Path, count: int, rounds: int) -> Path:
    """A project's folder with a journal and its recordings."""
    chance = random.Random(7)
    path = folder / ".mutabot" / "journal.sqlite"
    tests = [f"tests/test_cell.py::test_step_{number}[{number % 3}]" for number in range(TESTS)]
    planned = [*mutants(count)]
    sites = {candidate.site.id: sorted(chance.sample(range(TESTS), 12)) for candidate in planned}
    meta = {
        "mutabot": "0.1.0",
        "python": "3.11",
        "draws": ["noise"],
        "root": str(folder),
        "seed": 1,
        "rounds": rounds,
        "engine": "fork",
        "families": ["robot", "conventional"],
        "started": time.time(),
        "reaching": {"tests": tests, "sites": sites},
    }
    lines = "\n".join(f"    arm.move_by(dx={0.001 * line:.3f}, dy=0.0)" for line in range(LINES))
    with Journal.create(path, meta=meta) as journal, Recordings.to_write(path, KEPT) as kept:
        for round in range(rounds):
            for test in tests:
                end = TestEnd(test, "passed", wall=0.5, simulated=LENGTH)
                journal.add_tests([BaselineTest.of(round, 0, end)])
            for test in tests[:3]:
                kept.add(ORIGINAL, round, test, Rank.ORIGINAL, to_bytes(recording(0, None)))
        journal.set_plan(planned, (), sources={f"cell/part_{file}.py": lines for file in range(FILES)})
        for mutant in planned:
            usual = chance.choice(VERDICTS)
            for round in range(rounds):
                verdict = usual if chance.random() < 0.9 else chance.choice(VERDICTS)
                journal.add_outcome(_outcome(mutant, round, verdict, tests, chance))
                if verdict in (Verdict.KILLED, Verdict.SURVIVED):
                    made = recording(mutant.number * 10 + round, 2.0 + mutant.number % 15)
                    kept.add(mutant.id, round, tests[mutant.number % 3], Rank.SURVIVOR, to_bytes(made))
        journal.finish("complete")
    return path


def _outcome(
    mutant: Mutant, round: int, verdict: Verdict, tests: list[str], chance: random.Random
) -> Outcome:
    test = tests[mutant.number % 3]
    common = Outcome(mutant.id, round, verdict, hits=2, acted=2, example=(0.25, -0.25), tests=12, wall=0.2)
    if verdict is Verdict.KILLED:
        return replace(
            common,
            by=chance.choice([*By]),
            test=test,
            exception="builtins:AssertionError",
            message="assert 0.412 == approx(0.35 ± 0.02)",
            diverged=(_diverged(test, chance),),
        )
    if verdict is Verdict.SURVIVED:
        checks = tuple(
            Check(f"tests/test_cell.py:{line}", "abs(box().x - goal) < 0.02", "abs(0.41 - 0.42) < 0.02", 0.01)
            for line in range(8)
        )
        return replace(
            common,
            indistinguishable=False,
            distance=chance.uniform(1, 300),
            divergence=("world.box.x: 0.8 instead of 0.488 (off by 0.312)",),
            looked=tuple(Looked(test_name, acted=True, checks=checks) for test_name in tests[:2]),
            diverged=(_diverged(test, chance),),
        )
    return common


def _diverged(test: str, chance: random.Random) -> Diverged:
    apart = (
        Apart("box", "m", 2.0, 0.31, 6.1, 0.31, 0.3, 0.001),
        Apart("tool", "m", 2.0, 0.5, 6.0, 0.0, 0.4, 0.001),
    )
    slipped = f"box slipped from gripper at {chance.uniform(1, 9):.1f} s, 40 mm above table"
    story = f"{slipped}; box ended 0.31 m from where it ends in the original"
    return Diverged(test, 2.0, "box is not where it is in the original", story, apart, fault=2.0)


def write(journal: Path, folder: Path) -> tuple[Written, float, float]:
    """The report, the seconds that it took by the clock, and those of the processor."""
    began, used = time.perf_counter(), time.process_time()
    campaign = portable(mutabot.open(journal))
    with closing(StoredEvidence(journal)) as evidence:
        written = write_folder(folder, Contents(campaign, "made up", evidence, str))
    return written, time.perf_counter() - began, time.process_time() - used


def opened(page_file: Path, repeats: int) -> dict[str, float] | None:
    """Milliseconds in Chromium: until the page can be used, and per filter; None without a browser."""
    try:
        from playwright.sync_api import sync_playwright  # noqa: PLC0415
    except ImportError:
        return None
    ready, filters, paints, mutant_pages = [], [], [], []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for _ in range(repeats):
            page = browser.new_page(viewport={"width": 1280, "height": 900})
            page.goto(f"{page_file.as_uri()}#/mutants")
            page.wait_for_selector("table.mutants tbody tr")
            ready.append(page.evaluate("performance.getEntriesByName('ready')[0].startTime"))
            for text in ("slipped", "part_3", "reverse 0.1", "", "step_12"):
                page.evaluate("performance.clearMeasures()")
                paints.append(page.evaluate(_FILTER, text))
                filters.append(
                    page.evaluate(
                        "Math.max(...performance.getEntriesByName('filter').map((one) => one.duration))"
                    )
                )
            mutant_pages.append(page.evaluate(_OPEN))
            page.close()
        browser.close()
    return {
        "interactive_ms": statistics.median(ready),
        "filter_ms": max(filters),
        "filter_to_paint_ms": max(paints),
        "mutant_page_ms": statistics.median(mutant_pages),
    }


#: types into the search box, and waits until what it found is painted
_FILTER = """(text) => new Promise((done) => {
  const box = document.getElementById("search");
  const began = performance.now();
  box.value = text;
  box.dispatchEvent(new Event("input", { bubbles: true }));
  requestAnimationFrame(() => {
    const port = new MessageChannel();
    port.port1.onmessage = () => done(performance.now() - began);
    port.port2.postMessage(0);
  });
})"""
#: opens a mutant's page, and waits until its drawing is there
_OPEN = """() => new Promise((done) => {
  const began = performance.now();
  const isThere = () => document.querySelector("canvas.scene, .robot .empty");
  const end = () => requestAnimationFrame(() => done(performance.now() - began));
  const look = () => (isThere() ? end() : setTimeout(look, 2));
  location.hash = "#/mutant/17";
  look();
})"""


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--mutants", type=int, default=2000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--repeats", type=int, default=5, help="how often the page is opened")
    parser.add_argument("--keep", type=Path, help="a new folder for the campaign and its report")
    parser.add_argument("--json", action="store_true", help="print JSON instead of text")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = given.keep or Path(name)
        journal = folder / ".mutabot" / "journal.sqlite"
        if not journal.exists():
            build(folder.resolve(), given.mutants, given.rounds)
        written, seconds, cpu = write(journal, folder.resolve() / "report")
        times = opened(written.page, given.repeats)
        files = sum(1 for path in written.page.parent.rglob("*") if path.is_file())
    found: dict[str, Any] = {
        "mutants": given.mutants,
        "rounds": given.rounds,
        "bytes": written.size,
        "files": files,
        "seconds": round(seconds, 1),
        "cpu_seconds": round(cpu, 1),
        "recordings_without_room": written.without,
        "browser": times,
    }
    wrong = [] if written.size < LARGEST else [f"the report has {written.size} bytes"]
    wrong += (
        [f"a filter took {times['filter_ms']:.0f} ms"]
        if times and times["filter_ms"] >= SLOWEST_FILTER
        else []
    )
    if given.json:
        print(json.dumps({**found, "broken": wrong}, indent=2))
        return 1 if wrong else 0
    print(f"{given.mutants} mutants x {given.rounds} rounds: {written.size / 1e6:.1f} MB in {files} files,")
    print(f"  written in {seconds:.1f} s ({cpu:.1f} s of the processor),", end=" ")
    print(f"recordings for which there was no room: {written.without}")
    if times is None:
        print("  not measured in a browser: Playwright is not installed (requirements-reports.lock)")
    else:
        print(f"  Chromium: to interactive {times['interactive_ms']:.0f} ms,", end=" ")
        print(f"slowest filter {times['filter_ms']:.1f} ms", end=" ")
        print(f"({times['filter_to_paint_ms']:.0f} ms until painted),", end=" ")
        print(f"a mutant's page {times['mutant_page_ms']:.0f} ms")
    print("\n".join(f"BROKEN: {text}" for text in wrong) or "all promises are kept")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
