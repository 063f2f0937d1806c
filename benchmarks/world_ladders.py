"""How large a disturbance of its world does a test of each cell example notice, and what happens then?

Each parameter of ``mutabot_cell:world.toml`` disturbs one test of an example by all magnitudes of its ladder,
in one round. What is printed is ``docs/world-ladders.md``.

Use: ``python benchmarks/world_ladders.py [EXAMPLE …] [--only PARAMETER …] [--jobs N] [--folder FOLDER]``. In
the folder the campaigns stay, so that one that was interrupted goes on.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from mutabot.journal.journal import Journal  # noqa: E402
from mutabot.results.results import read_results  # noqa: E402
from mutabot_world.ladders import WorldEnd, WorldLadder, combined_ladders, ladders  # noqa: E402
from mutabot_world.units import with_unit  # noqa: E402
from suites.corpus import copied  # noqa: E402


@dataclass(frozen=True)
class Laddered:
    """What is disturbed of an example.

    Attributes:
        test: node id.
        tolerances: what the test allows at the end, by unit; without them 1 mm and 0.5 degrees.
        names: which things a parameter means, where they have other names than in most cells.
    """

    test: str
    tolerances: Mapping[str, float] = field(default_factory=dict)
    names: Mapping[str, str] = field(default_factory=dict)


EXAMPLES = {
    "paper": Laddered("tests/test_mission.py"),
    "pick_and_place": Laddered(
        "tests/test_sorting.py::test_a_box_is_set_down_at_the_place_of_its_colour[red]",
        {"m": 0.0035, "deg": 3.0},
    ),
    "tracking": Laddered(
        "tests/test_picking.py::test_a_box_is_picked_from_the_moving_belt_and_set_down_in_time",
        {"m": 0.0035, "deg": 3.0},
    ),
    "palletising": Laddered(
        "tests/test_palletising.py::test_a_box_further_away_on_the_belt_is_waited_for",
        {"m": 0.0045, "deg": 1.0},
        {"table height": "pallet"},
    ),
}
HEAD = ("parameter", "tried", "lived with up to", "suffered unseen at", "noticed from", "what happened there")
PAGE = """\
# Ladders of the simulated cell

<!-- Printed by benchmarks/world_ladders.py. Do not edit. -->

What the [disturbances](world.md) of the simulated cell do to one test of each example, in one round. "Lived
with" and "suffered unseen" go by what the test itself allows; in examples/paper, by 1 mm and 0.5°.
The last column says what happened at the largest magnitude that is suffered unseen, else at the threshold,
else at the largest one tried; a protective stop names what touched at that moment, however lightly. Long
values in messages are cut by pytest. `vacuum leak` is an opening in m² (1e-06: a hole of 1.1 mm).
"""


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("examples", nargs="*", choices=[*EXAMPLES, []])
    parser.add_argument("--only", nargs="+", default=[])
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--folder", type=Path)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = (given.folder or Path(temporary)).resolve()
        print(PAGE)
        for name in given.examples or EXAMPLES:
            found = measured(name, folder / name, given.only, given.jobs)
            print("\n".join([*heading(name), *table(found), "", *without(found)]), flush=True)
    return 0


def measured(name: str, copy: Path, only: Sequence[str], jobs: int) -> list[WorldLadder]:
    """Run the campaign in a copy of an example, or go on with it; return a ladder for each parameter."""
    what = EXAMPLES[name]
    if not copy.is_dir():
        copied(ROOT / "examples" / name, copy)
        named = {key: value for key, value in what.names.items() if key in (only or what.names)}
        names = ", ".join(f'"{key}" = "{value}"' for key, value in named.items())
        lines = (
            f'tests = ["{what.test}"]',
            "[tool.mutabot.world]",
            'parameters = ["mutabot_cell:world.toml"]',
            *([f"only = {[*only]}"] if only else []),
            f"names = {{ {names} }}",
        )
        # the table of mutabot is the last one of these files
        with (copy / "pyproject.toml").open("a", encoding="utf-8") as file:
            file.write("\n".join([*lines, ""]))
    words = [
        sys.executable,
        "-m",
        "mutabot.cli.app",
        "run",
        "--family",
        "world",
        "--rounds",
        "1",
        "-j",
        str(jobs),
    ]
    done = subprocess.run(words, cwd=copy, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{name}: exit code {done.returncode}: {done.stdout[-1000:]}")
    with Journal.open(copy / ".mutabot" / "journal.sqlite") as journal:
        return combined_ladders(ladders(read_results(journal), what.tolerances))


def heading(name: str) -> Iterator[str]:
    """Yield the heading of an example, its test and what that allows."""
    what = EXAMPLES[name]
    yield f"## {name}"
    yield ""
    allowed = " and ".join(_allowed(value, unit) for unit, value in what.tolerances.items())
    yield f"`{what.test}`" + (f", which allows {allowed}" if allowed else "")
    yield ""


def _allowed(value: float, unit: str) -> str:
    return with_unit(value * 1000, "mm") if unit == "m" else with_unit(value, unit)


def table(found: Sequence[WorldLadder]) -> Iterator[str]:
    """Yield the lines of a table: what is suffered unseen, noticed and lived with, and what happened."""
    yield f"| {' | '.join(HEAD)} |"
    yield f"|{'---|' * len(HEAD)}"
    for ladder in found:
        if ladder.ends:
            yield f"| {' | '.join(_row(ladder))} |"


def without(found: Sequence[WorldLadder]) -> Iterator[str]:
    """Yield what the example has nothing of."""
    names = list(dict.fromkeys(f"`{ladder.parameter}`" for ladder in found if not ladder.ends))
    if names:
        yield f"The test has nothing of what these disturb: {', '.join(names)}."
        yield ""


def _row(ladder: WorldLadder) -> Iterator[str]:
    sizes = sorted(ladder.found)
    yield f"{ladder.parameter} {ladder.direction.replace('-', '−')}".strip()
    yield f"{sizes[0]:g} to {with_unit(sizes[-1], ladder.unit)}"
    yield "none" if ladder.robust_to is None else with_unit(ladder.robust_to, ladder.unit)
    least, most = (ladder.unseen[0], ladder.unseen[-1]) if ladder.unseen else (0.0, 0.0)
    span = with_unit(most, ladder.unit) if least == most else f"{least:g} to {with_unit(most, ladder.unit)}"
    yield span if ladder.unseen else ""
    some = [with_unit(size, ladder.unit) for size, end in ladder.ends.items() if end is WorldEnd.NOTICED]
    never = f"never, but {' and '.join(some)} is" if some else "never"
    yield never if ladder.noticed_from is None else with_unit(ladder.noticed_from, ladder.unit)
    yield _happened(ladder)


def _happened(ladder: WorldLadder) -> str:
    """What happened at the largest magnitude that is suffered unseen, or at the threshold."""
    if ladder.unseen:
        story = ladder.story(ladder.unseen[-1], WorldEnd.UNSEEN)[0]
    elif ladder.noticed_from is not None:
        story = ladder.story(ladder.noticed_from, WorldEnd.NOTICED)[0]
    else:
        story = ladder.story(max(ladder.ends), WorldEnd.LIVED)[0]
    # what a monitor read when its condition broke is of no use in a table
    return re.sub(r"(t=[\d.]+ s): time=.*", r"\1", story).replace("|", "\\|") or "nothing differs"


if __name__ == "__main__":
    sys.exit(main())
