"""Are the stories true? Each sentence about a survivor against a simulation that mutabot does not watch.

    python benchmarks/stories_judged.py [--count N] [--sample N] [--bare] [EXAMPLE or FOLDER ...]

Runs a campaign of each example, draws survivors by a fixed seed, edits the source text of a copy by hand for
each (``tests/suites/editor.py``) and runs the test of its story by plain pytest with a plug-in of this script
that writes the whole cell down after each control tick; likewise the original. Each part of the story, and
the original's value beside it, must hold within the tolerances of ``stories/claims.py``; no story may be told
in a test in which the original itself ends far apart with other seeds, unless it says so; and where nothing
differs, nothing may. The exit code is 1 if anything is untrue, or nothing was judged. A FOLDER is a project
whose campaign has run; its stories are made anew from what was recorded.
``--bare`` takes the conditions that hold at every moment out of the tests, so that more survives.
"""

from __future__ import annotations

import argparse
import json
import os
import pickle
import random
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import combinations
from pathlib import Path

import numpy as np

from stories.cells import Watched
from stories.claims import SAME, Runs

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from mutabot.evidence.paths import RecordedPaths  # noqa: E402
from mutabot.evidence.recording import from_bytes  # noqa: E402
from mutabot.evidence.spread import spread_between  # noqa: E402
from mutabot.evidence.story import diverged  # noqa: E402
from mutabot.journal.journal import Journal  # noqa: E402
from mutabot.journal.recordings import ORIGINAL, Recordings  # noqa: E402
from mutabot.model import Diverged  # noqa: E402
from mutabot.report.document import data_of  # noqa: E402
from mutabot.results.results import MutantResult, read_results  # noqa: E402
from mutabot.runtime.seeds import derive  # noqa: E402
from suites.editor import CannotWriteError, Edit, Facts  # noqa: E402
from suites.judge import IGNORED, PLANTED, SEEDS, is_drawn  # noqa: E402
from suites.message_editor import edits_of  # noqa: E402

EXAMPLES = ("pick_and_place", "tracking", "palletising")
BARE = "\n\nCell.always = lambda *_, **__: None\n"
#: m: a thing that ends farther apart than this with other seeds has no stable end
SCATTERED = 0.1
#: rounds whose seeds are compared
SEEDED = 3


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("projects", nargs="*", default=EXAMPLES)
    parser.add_argument("--count", type=int, default=20, help="survivors of each")
    parser.add_argument("--sample", help="of the mutants, as `mutabot run --sample`")
    parser.add_argument("--bare", action="store_true")
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as home:
        for name in given.projects:
            folder = Path(name).resolve()
            if not (folder / ".mutabot").is_dir():
                folder = campaign(Path(home), name, given.sample, is_bare=given.bare)
            counts += judged(folder, given.count)
    print(", ".join(f"{count} {what}" for what, count in counts.items()))
    return int(bool(counts["untrue"]) or not (counts["sentences"] or counts["nothing differs"]))


def campaign(home: Path, name: str, sample: str | None, *, is_bare: bool) -> Path:
    """A copy of an example whose campaign has run."""
    folder = home / name
    shutil.copytree(ROOT / "examples" / name, folder, ignore=IGNORED)
    if is_bare:
        with (folder / "tests" / "conftest.py").open("a") as file:
            file.write(BARE)
    words = [sys.executable, "-m", "mutabot", "run", "--rounds", "1"]
    subprocess.run([*words, *(["--sample", sample] if sample else [])], cwd=folder, check=True,
                   stdout=subprocess.DEVNULL)  # fmt: skip
    return folder


def judged(folder: Path, count: int) -> Counter[str]:
    """Judge survivors of a project; print what is untrue."""
    with Journal.open(folder / ".mutabot" / "journal.sqlite") as journal:
        results = read_results(journal)
    survivors = [
        mutant for mutant in results.mutants if mutant.survived and not is_drawn(data_of(mutant.mutant))
    ]
    drawn = random.Random(1).sample(survivors, min(count, len(survivors)))
    simulation = Simulation(folder, results.meta["seed"])
    counts: Counter[str] = Counter()
    for result in sorted(drawn, key=lambda found_result: found_result.mutant.number):
        counts["survivors"] += 1
        try:
            lines = list(simulation.untrue(result, counts))
        except CannotWriteError as error:
            counts["not written"] += 1
            lines = []
            print(f"{folder.name} #{result.mutant.number} cannot be written: {error}")
        counts["untrue"] += len(lines)
        for line in lines:
            print(
                f"{folder.name} #{result.mutant.number} {result.mutant.description}\n    {line}", flush=True
            )
    print(f"{folder.name}: {dict(counts)}", flush=True)
    return counts


class Simulation:
    """Runs tests of a project, edited by hand, by plain pytest.

    Args:
        folder: the project.
        seed: of its campaign.
    """

    def __init__(self, folder: Path, seed: int) -> None:
        self.folder, self.seed = folder, seed
        self.original = lru_cache(None)(self._original)

    def untrue(self, result: MutantResult, counts: Counter[str]) -> Iterator[str]:
        """Yield what is not true of a survivor's story, a line each."""
        edits = edits_of(Facts.of(self.folder), data_of(result.mutant))
        told = self.told(result)
        if told is None:
            counts["nothing differs"] += 1
            ran = self.run(edits, None, 0)
            for test, cells in self.original(None, 0).items():
                yield from (f"{test}: {line}" for line in _differing(cells, ran.get(test, [])))
            return
        runs = self.original(told.test, 0), self.run(edits, told.test, 0)
        original, mutant = (run.get(told.test, []) for run in runs)
        if len(original) != 1 or len(mutant) != 1:
            counts["several cells"] += 1
            return
        spread = self.spread(told.test)
        scattered = any(far > SCATTERED for far in spread.values())
        story = told.story
        if told.scatters:
            counts["told where the original scatters, and said so"] += 1
            story = story.partition("): ")[2]
        elif scattered and story:
            yield f"{told.test}: the original itself scatters there: {spread}"
        if story:
            counts["sentences"] += len(story.split("; "))
            yield from Runs(original[0], mutant[0], spread).untrue(story)

    def told(self, result: MutantResult) -> Diverged | None:
        """The story of a survivor, from what its campaign recorded."""
        found = []
        kept = Recordings.to_read(self.folder / ".mutabot" / "journal.sqlite")
        if kept is None:
            return None
        with kept as recordings:
            for test, _, data in recordings.of(result.mutant.id, 0):
                known = [recordings.data(ORIGINAL, round, test) for round in range(SEEDED)]
                runs = [RecordedPaths(from_bytes(recorded)) for recorded in known if recorded is not None]
                mutant = RecordedPaths(from_bytes(data))
                found.append(diverged(test, runs[0], mutant, spread=spread_between(runs)))
        return max(
            (divergence for divergence in found if divergence is not None),
            key=lambda divergence: divergence.rank,
            default=None,
        )

    def spread(self, test: str) -> dict[str, float]:
        """How far each thing ends apart with other seeds, m."""
        runs = [self.original(test, round)[test][0] for round in range(SEEDED)]
        found: dict[str, float] = {}
        for left, right in combinations(runs, 2):
            for name in left.poses.keys() & right.poses.keys():
                first, second = left.poses[name][:, :3], right.poses[name][:, :3]
                ends = float(np.linalg.norm(first[-1] - second[-1]))
                moved = float(np.linalg.norm((first[-1] - first[0]) - (second[-1] - second[0])))
                found[name] = max(found.get(name, 0.0), min(ends, moved))
        return found

    def _original(self, test: str | None, round: int) -> dict[str, list[Watched]]:
        return self.run([], test, round)

    def run(self, edits: Sequence[Edit], test: str | None, round: int) -> dict[str, list[Watched]]:
        """What happens in a test, or in all, with the seeds of a round: its cells, by test."""
        facts = Facts.of(self.folder)
        with tempfile.TemporaryDirectory() as name:
            place = Path(name)
            copy, planted, written = place / self.folder.name, place / "planted", place / "watched"
            shutil.copytree(self.folder, copy, ignore=IGNORED)
            planted.mkdir()
            for file in PLANTED:
                shutil.copy(file, planted / f"_{file.name}")
            (planted / "_judge_seeds.py").write_text(SEEDS)
            shutil.copy(Path(__file__).parent / "stories" / "watch.py", planted / "_watch.py")
            for edit in sorted(edits, key=lambda edit: (edit.file, edit.start), reverse=True):
                target = copy / edit.file
                target.write_bytes(edit.applied(target.read_bytes()))
            environment = {
                **os.environ, "PYTHONPATH": str(planted), "PYTHONHASHSEED": "0", "WATCH": str(written),
                "JUDGE_NOISE": "1",
                "JUDGE_NOTES": str(place / "notes"), "JUDGE_SEEDS": json.dumps(self.seeds(round)),
            }  # fmt: skip
            words = [sys.executable, "-m", "pytest", "-q", "-p", "no:mutabot", "-p", "no:cacheprovider",
                     "-p", "_judge_seeds", "-p", "_watch", *facts.settings.get("pytest_args", []),
                     test or "tests"]  # fmt: skip
            ended = subprocess.run(
                words, cwd=copy, env=environment, capture_output=True, text=True, check=False
            )
            if ended.returncode:
                raise RuntimeError(f"pytest fails although it is a survivor:\n{ended.stdout[-3000:]}")
            seen = pickle.loads(written.read_bytes())
        return {test: [Watched(cell) for cell in cells] for test, cells in seen.items()}

    def seeds(self, round: int) -> Mapping[str, int]:
        """What the fixture ``mutabot_seed`` gives in a round, by test."""
        with Journal.open(self.folder / ".mutabot" / "journal.sqlite") as journal:
            tests = [baseline_test.test.test for baseline_test in journal.tests()]
        return {test: derive(self.seed, round, test) for test in tests}


def _differing(original: Sequence[Watched], mutant: Sequence[Watched]) -> Iterator[str]:
    """Where two runs are not the same at the same time, though nothing is said to differ."""
    if len(original) != len(mutant):
        yield f"{len(mutant)} cells instead of {len(original)}"
        return
    for first, second in zip(original, mutant, strict=True):
        count = min(len(first.times), len(second.times))
        for name in first.poses:
            gaps = np.linalg.norm(first.poses[name][:count, :3] - second.poses[name][:count, :3], axis=1)
            if gaps.max() > SAME:
                yield f"{name} is {gaps.max():.4f} m away at {first.times[gaps.argmax()]:.2f} s"
        if abs(first.times[-1] - second.times[-1]) > 0.15:
            yield f"ends at {second.times[-1]:.2f} s instead of {first.times[-1]:.2f} s"


if __name__ == "__main__":
    sys.exit(main())
