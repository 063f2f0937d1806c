"""Do operators and suites behave alike on other tasks? Campaigns on the examples, and docs/tasks.md.

    python benchmarks/tasks.py run NAME [--robot 60] [--conventional 20]   keep docs/data/tasks/NAME.json
    python benchmarks/tasks.py                                             write the page from what is kept
    python benchmarks/tasks.py --check                                     exit with 1 if it is out of date

A campaign for each family runs the mutants of the program against every test that reaches them. So it tells
for each mutant what the weak, the medium and the strong suite notice: a suite notices what one of its tests
does, in the same rounds with the same seeds. NAME is an example, or a recipe of docs/recipes: a program that
drives a robot library or simulator of others, in an environment that has it (``make .venv-shipped/.ready``).
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

from comparison.across import STRENGTHS, UNKNOWN
from comparison.claims import family_of
from comparison.data import comparison_data
from comparison.families import compare_families
from comparison.run import campaign
from comparison.tasks_page import ORDER, ROBOT, TEXT, page
from foreign_programs import RECIPES, run_mutabot, write_project
from mutabot.cli.options import Running
from mutabot.model import Outcome
from mutabot.report.document import dumps
from mutabot.results.results import MutantResult, Results

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"


def kept(results: Results, family: str) -> dict[str, Any]:
    """What the page needs of a campaign on one family."""
    data = comparison_data(compare_families(results))
    mutants = [
        {
            "place": result.mutant.site.span.place,
            "operator": result.mutant.operator,
            "fault": result.mutant.description,
            "ends": mutant["ends"],
            "noticed": noticed(result),
        }
        for mutant, result in zip(data["mutants"], results.mutants, strict=True)
    ]
    own = family_of(data, family)
    return {**{key: data[key] for key in ("state", "meta", "sample")}, "families": own, "mutants": mutants}


def noticed(result: MutantResult) -> list[str | None]:
    """By round, the weakest suite that notices a mutant; None if none does.

    "all" where the tests are one suite, "unknown" where the process ended before it came to a weaker one.
    """
    return [_weakest(outcome) if outcome is not None else None for outcome in result.rounds]


def _weakest(outcome: Outcome) -> str | None:
    tests = outcome.noticing_tests
    folders = {test.split("/")[1] for test in tests if test.count("/") > 1}
    found = next((strength for strength in STRENGTHS if strength in folders), "all" if tests else None)
    return found if outcome.complete or found in ("weak", "all", None) else UNKNOWN


def weak_first(project: Path) -> list[str]:
    """The setting that runs weaker suites first: a process that ends early ends in the weakest."""
    folders = [f"tests/{strength}" for strength in STRENGTHS if (project / "tests" / strength).is_dir()]
    return [f"tests={json.dumps(folders)}"] if folders else []


def load(folder: Path) -> dict[str, Any]:
    """What is kept of each task, by name, in the order of the page."""
    files = {file.stem: file for file in sorted(folder.glob("*.json"))}
    names = [*(name for name in ORDER if name in files), *(name for name in files if name not in ORDER)]
    return {name: json.loads(files[name].read_text(encoding="utf-8")) for name in names}


def main(arguments: list[str] | None = None, docs: Path = DOCS) -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", nargs="?", choices=["run"])
    parser.add_argument("name", nargs="?", help="of an example or a recipe")
    parser.add_argument("--robot", metavar="SIZE", help="a sample of the robot family; else all")
    parser.add_argument(
        "--conventional", metavar="SIZE", help="a sample of the conventional family; else all"
    )
    parser.add_argument("--family", action="append", choices=[ROBOT, TEXT], help="else both")
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--folder", type=Path, help="keeps journals, so that larger samples go on from them")
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args(arguments)
    if given.what == "run":
        if not given.name:
            parser.error("which example or recipe?")
        if not (ROOT / "examples" / given.name).is_dir() and given.name not in RECIPES:
            parser.error(f"no example or recipe {given.name}; recipes are {', '.join(RECIPES)}")
        return _run(given, docs / "data" / "tasks")
    tasks = load(docs / "data" / "tasks")
    text, file = page(tasks), docs / "tasks.md"
    if given.check:
        is_current = file.is_file() and file.read_text(encoding="utf-8") == text
        print(f"{file.name}: {'up to date' if is_current else 'out of date'}, {len(tasks)} tasks")
        return int(not is_current)
    file.write_text(text, encoding="utf-8")
    return 0


def _project(name: str, folder: Path) -> Path:
    """The folder of an example, or of a recipe that is written there; raises SystemExit if `init` fails."""
    if name not in RECIPES:
        return ROOT / "examples" / name
    write_project(name, folder)
    done = run_mutabot(folder, "init")
    if done.returncode:
        sys.exit(f"mutabot init on the recipe {name}: {done.stderr}")
    return folder


def _run(given: argparse.Namespace, data: Path) -> int:
    """Run the campaigns of a task, and keep what they find if both are complete."""
    found = {}
    with tempfile.TemporaryDirectory() as temporary:
        project = _project(given.name, Path(temporary, "project"))
        for family, sample in ((ROBOT, given.robot), (TEXT, given.conventional)):
            if given.family and family not in given.family:
                continue
            options = Running(
                family=[family], only=["program"], rounds=given.rounds, seed=given.seed, sample=sample,
                jobs=given.jobs, settings=weak_first(project),
            )  # fmt: skip
            folder = (given.folder or Path(temporary)) / family
            folder.mkdir(parents=True, exist_ok=True)
            found[family] = kept(campaign(project, folder / given.name, options), family)
            print(
                f"{given.name}, {family}: {found[family]['state']}, {len(found[family]['mutants'])} mutants"
            )
    if any(state["state"] != "complete" for state in found.values()):
        return 1
    data.mkdir(parents=True, exist_ok=True)
    lines = json.dumps(json.loads(dumps({"campaigns": found})), ensure_ascii=False, indent=None)
    (data / f"{given.name}.json").write_text(lines.replace('{"place"', '\n{"place"') + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
