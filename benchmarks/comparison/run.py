"""Run the mutants of several families on one project, and print the comparison as JSON.

    cd benchmarks
    python -m comparison.run ../examples/paper --rounds 5 > paper.json

Every mutant runs against every test that reaches it: otherwise nobody could say which mutants are trivial or
redundant. A second campaign runs the same mutants with the checks of the tests switched off (see
``without_checks``). Both run on copies, so the project keeps its own journal.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from mutabot.campaign.request import Request
from mutabot.campaign.run import run_campaign
from mutabot.cli.options import Running
from mutabot.cli.request import request_of
from mutabot.families import GRADED
from mutabot.faults import known_families
from mutabot.journal.files import HOME
from mutabot.journal.reader import JournalReader
from mutabot.report.document import dumps
from mutabot.report.terminal.console import make_console
from mutabot.report.terminal.progress import make_progress
from mutabot.results.results import Results, read_results

from . import without_checks
from .data import comparison_data
from .families import compare_families

#: graded mutants have thresholds and no score; what real bugs ask for has a benchmark of its own
COMPARED = tuple(name for name in known_families() if name not in (GRADED, "bugs", "patch"))


def main() -> int:
    """Run both campaigns, print the comparison."""
    parser = argparse.ArgumentParser(description="Compare families of mutants on one project.")
    parser.add_argument("project", type=Path)
    parser.add_argument("--family", action="append", choices=COMPARED, help="repeatable; all if left out")
    parser.add_argument("--rounds", type=int)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--sample", help="10%% or a number, as for `mutabot run`")
    given = parser.parse_args()
    options = Running(
        family=given.family or [*COMPARED], rounds=given.rounds, seed=given.seed, sample=given.sample
    )
    with tempfile.TemporaryDirectory() as folder:
        checked = campaign(given.project, Path(folder, "checked"), options)
        unchecked = campaign(given.project, Path(folder, "unchecked"), options, checks=False)
    print(dumps(comparison_data(compare_families(checked, unchecked))))
    return 0


def campaign(project: Path, copy: Path, options: Running, *, checks: bool = True) -> Results:
    """What a campaign on a copy of the project finds; a copy that is there goes on from its journal."""
    if not copy.exists():
        shutil.copytree(project, copy, ignore=shutil.ignore_patterns(HOME, "__pycache__"))
    request = request_of(copy, **options)
    request = replace(request, every_test=checks)
    if not checks:
        request, variables = switched_off(request)
        os.environ.update(variables)
    with make_progress(make_console(stderr=True)) as progress:
        path = run_campaign(request, progress)
    with JournalReader.open(path) as journal:
        return read_results(journal)


def switched_off(request: Request) -> tuple[Request, dict[str, str]]:
    """The same campaign without the checks of the tests, and the variables that it needs."""
    configuration = request.configuration
    files = {
        "root": str(request.root),
        "program": configuration.program,
        "oracle": configuration.oracle,
        "checks": request.vocabulary.checks,
    }
    paths = (str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH"))
    variables = {
        "PYTHONPATH": os.pathsep.join(filter(None, paths)),
        without_checks.ENVIRONMENT: json.dumps(files),
    }
    arguments = (*configuration.pytest_args, "-p", without_checks.__name__)
    return replace(
        request, configuration=configuration.model_copy(update={"pytest_args": arguments})
    ), variables


if __name__ == "__main__":
    sys.exit(main())
