"""Thresholds of the examples, held against what they must be.

    python benchmarks/thresholds.py search|seeds|published|suites [--only WHICH …] [--rounds N] [--jobs N]

- ``search``: examples/pick_and_place, by the search and by whole ladders: runs, seconds, and whether every
  bracket is the same.
- ``seeds``: the same ladders with other seeds. How often does the bracket of a campaign hold the median of
  all the others' rounds?
- ``published``: the published test compares metres that it rounds to centimetres. Does each magnitude of an
  offset in what it reads end as that formula says?
- ``suites``: three versions of the suite of pick_and_place (all checks; tolerances four times as wide; no
  assertions, so that monitors and exceptions are left) must be ranked so by the thresholds of every round.
"""

from __future__ import annotations

import argparse
import ast
import re
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from itertools import pairwise
from math import comb
from pathlib import Path
from statistics import median
from typing import Any
from unittest.mock import patch

from mutabot.campaign.request import Request
from mutabot.campaign.run import run_campaign
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.journal.journal import Journal
from mutabot.model.graded import Bracket, MagnitudeResult, bracket_of, seen

ROOT = Path(__file__).resolve().parent.parent
#: of pick_and_place: relative moves in x, y and z
MOVES = ("sorting.py:*:cell.arm.move_by#*:?:offset=*",)
#: tolerances of its suite
TOLERANCES = re.compile(r"^((?:\w+_WITHIN\w*|ANOTHER_\w+) = )([\d.]+)$", re.MULTILINE)
Rows = dict[tuple[str, int], dict[float, MagnitudeResult]]


class Silent:
    """Nobody looks on."""

    def stage(self, text: str, total: int | None = None) -> None: ...

    def advance(self, line: str | None = None) -> None: ...

    def note(self, text: str) -> None:
        if text.startswith("thresholds"):
            print(f"  {text}", flush=True)


def request_of(folder: Path, given: argparse.Namespace, **more: Any) -> Request:
    """The request of ``mutabot run --family graded --fresh``."""
    configuration = load_configuration(folder)
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    request = Request(
        configuration, vocabulary, given.rounds, 1, given.jobs,
        only=tuple(given.only or MOVES), families=("graded",), fresh=True,
    )  # fmt: skip
    return replace(request, **more)


def copy_of(example: str, place: Path) -> Path:
    """A copy of an example."""
    ignored = shutil.ignore_patterns(".mutabot", "__pycache__", ".pytest_cache")
    return Path(shutil.copytree(ROOT / "examples" / example, place / example, ignore=ignored))


def rows_of(request: Request, *, whole: bool = False) -> tuple[Rows, float]:
    """What was seen at each magnitude, by ladder and round, and the seconds that it took.

    ``whole``: run every magnitude of a ladder in every round, instead of searching.
    """
    began = time.monotonic()
    splits: AbstractContextManager[object] = patch(
        "mutabot.campaign.schedule.split_ladders", lambda mutants: (mutants, {})
    )
    with splits if whole else nullcontext():
        path = run_campaign(request, Silent())
    seconds = time.monotonic() - began
    rows: Rows = {}
    with Journal.open(path) as journal:
        mutants = {one.id: one for one in journal.mutants()}
        for one in journal.outcomes():
            mutant = mutants[one.mutant]
            rows.setdefault((mutant.ladder, one.round), {})[mutant.magnitude or 0.0] = seen(one)
    return rows, seconds


def ends_of(bracket: Bracket) -> tuple[float, float]:
    """A bracket as numbers: 0 below the ladder, infinite above it."""
    return bracket.low or 0.0, float("inf") if bracket.high is None else bracket.high


def search(given: argparse.Namespace, place: Path) -> bool:
    """By the search, and by whole ladders."""
    folder = copy_of("pick_and_place", place)
    found, quick = rows_of(request_of(folder, given))
    whole, slow = rows_of(request_of(folder, given), whole=True)
    runs, all_runs = (sum(map(len, rows.values())) for rows in (found, whole))
    same = sum(ends_of(bracket_of(found[key])) == ends_of(bracket_of(row)) for key, row in whole.items())
    print(f"search: {runs} runs, {quick:.0f} s; whole ladders: {all_runs} runs, {slow:.0f} s")
    print(f"{runs / all_runs:.0%} of the runs, {quick / slow:.0%} of the time")
    print(f"{same} of {len(whole)} brackets of a ladder in a round are the same")
    return same == len(whole)


def seeds(given: argparse.Namespace, place: Path) -> bool:
    """With other seeds."""
    folder = copy_of("pick_and_place", place)
    campaigns = [rows_of(request_of(folder, given, seed=seed))[0] for seed in range(1, given.seeds + 1)]
    held = total = 0
    for ladder in sorted({name for rows in campaigns for name, _ in rows}):
        brackets = [
            [bracket_of(row) for (name, _), row in rows.items() if name == ladder] for rows in campaigns
        ]
        for index, own in enumerate(brackets):
            others = [one for other, those in enumerate(brackets) if other != index for one in those]
            if own and others:
                total += 1
                held += _holds(own, others)
    promised = 1 - 2 * 0.5**given.rounds
    fewer: float = sum(
        comb(total, count) * promised**count * (1 - promised) ** (total - count) for count in range(held + 1)
    )
    share = f"{held / total:.0%}; promised {promised:.0%}, which gives so few or fewer in {fewer:.0%}"
    print(f"{held} of {total} brackets hold the median of the other seeds' rounds ({share})")
    return fewer > 0.05


def _holds(own: list[Bracket], others: list[Bracket]) -> bool:
    """Whether (none up to, all from] may hold the median of the others, itself known as a bracket."""
    lows, highs = zip(*map(ends_of, own), strict=True)
    other_lows, other_highs = zip(*map(ends_of, others), strict=True)
    is_open = max(highs) == float("inf")
    return is_open or bool(median(other_lows) < max(highs) and median(other_highs) > min(lows))


def published(given: argparse.Namespace, place: Path) -> bool:
    """What the published test reads."""
    folder = copy_of("paper", place)
    sys.path.insert(0, str(folder / "tests"))
    from expected import HOME, ON_CONVEYOR, TARGETS, is_within  # noqa: PLC0415  # the test's own

    request = request_of(folder, given, only=("tests/sensors.py:*:.?:offset=*",))
    right, wrong = 0, []
    with Journal.open(run_campaign(request, Silent())) as journal:
        mutants = {one.id: one for one in journal.mutants()}
        outcomes = [one for one in journal.outcomes() if one.example and seen(one).is_valid]
    colours = {}  # of the box of each round, by where its y was read at the end
    for one in outcomes:
        assert one.example is not None  # those without one are left out
        read, mutant = one.example[0], mutants[one.mutant]
        if mutant.site.span.function == "box_end_position" and mutant.quantity == ".y":
            colours[one.round] = min(TARGETS, key=lambda name: abs(TARGETS[name].y - read))
    for one in outcomes:
        assert one.example is not None
        mutant = mutants[one.mutant]
        axis, occasion = (mutant.quantity or "")[-1], mutant.site.span.function
        spot, limit = {
            "robot_home_position": (HOME, 0.02),
            "box_start_position": (ON_CONVEYOR, 0.01),
            "box_end_position": (TARGETS[colours[one.round]], 0.02),
        }[occasion]
        wanted, after = getattr(spot, axis), one.example[1]
        said = MagnitudeResult.MISSED if is_within(wanted, after, limit) else MagnitudeResult.NOTICED
        if said is seen(one):
            right += 1
        else:
            what = f"{seen(one)}, the formula says {said} ({after:.4f} for {wanted:.4f})"
            wrong.append(f"{mutant.id} round {one.round + 1}: {what}")
    print(f"{right} of {right + len(wrong)} magnitudes end as the test's formula says")
    print("\n".join(wrong))
    return not wrong


def suites(given: argparse.Namespace, place: Path) -> bool:
    """Three versions of a suite."""
    found = {name: rows_of(request)[0] for name, request in _versions(given, place)}
    ranked = True
    for round in range(given.rounds):
        ladders = sorted({name for rows in found.values() for name, which in rows if which == round})
        steps = {name: _steps(rows, ladders, round) for name, rows in found.items()}
        means = {name: sum(those.values()) / len(those) for name, those in steps.items()}
        good = all(one < other for one, other in pairwise(means.values()))
        shown = ", ".join(f"{name} {mean:.2f}" for name, mean in means.items())
        print(f"round {round + 1}: mean steps to the threshold over {len(ladders)} ladders: {shown}")
        ranked = ranked and good
    print(f"ranked rightly in every round: {ranked}")
    return ranked


def _versions(given: argparse.Namespace, place: Path) -> Iterator[tuple[str, Request]]:
    for name in ("all checks", "tolerances × 4", "no assertions"):
        folder = copy_of("pick_and_place", place / name.replace(" ", "_"))
        if name == "tolerances × 4":
            file = folder / "tests" / "test_sorting.py"
            wider, count = TOLERANCES.subn(lambda one: f"{one[1]}{float(one[2]) * 4:g}", file.read_text())
            assert count > 3, "the suite's tolerances have other names now"
            file.write_text(wider)
        if name == "no assertions":
            for file in (folder / "tests").glob("*.py"):
                file.write_text(ast.unparse(_Unasserted().visit(ast.parse(file.read_text()))))
        yield name, request_of(folder, given)


class _Unasserted(ast.NodeTransformer):
    """What an assertion looks at is still worked out; nothing comes of it."""

    def visit_Assert(self, node: ast.Assert) -> ast.Expr:  # ast's name for it
        return ast.copy_location(ast.Expr(node.test), node)


def _steps(
    rows: Mapping[tuple[str, int], Mapping[float, MagnitudeResult]], ladders: list[str], round: int
) -> dict[str, int]:
    """At which step of 1-2-5 each threshold lies: the number of tried magnitudes up to it."""
    sizes = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
    return {
        name: sum(size < ends_of(bracket_of(rows.get((name, round), {})))[1] for size in sizes)
        for name in ladders
    }


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=("search", "seeds", "published", "suites"))
    parser.add_argument("--only", nargs="+", help="mutants, as `mutabot run --only` takes them")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seeds", type=int, default=4)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        good = globals()[given.what](given, Path(name))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
