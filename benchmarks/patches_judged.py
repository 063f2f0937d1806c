"""Do patches end as plain pytest says? Each is applied by ``git apply`` to a copy, where plain pytest runs.

Patches are made of the projects of the corpus (``tests/suites/projects``) by a fixed seed: one to three edits
of program and robot, such as a sign, a comparison or a lost statement, as ``git diff`` writes them.

Use: ``python benchmarks/patches_judged.py [NAME …] [--patches N] [--projects N]``. The exit code is 1 if one
verdict disagrees, or if there is nothing to compare.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from suites.corpus import copied, corpus  # noqa: E402

ENGINES = ("fork", "replay")
_NOT_FORKED = "it could not be forked"
_COMPARED = {ast.Lt: ">=", ast.Gt: "<=", ast.LtE: ">", ast.GtE: "<", ast.Eq: "!=", ast.NotEq: "=="}
#: first and last position in a text, and what stands there instead
Edit = tuple[int, int, str]


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", help="projects of the corpus")
    parser.add_argument("--patches", type=int, default=3, help="patches of each project")
    parser.add_argument("--projects", type=int, default=36, help="projects, drawn by a fixed seed")
    given = parser.parse_args()
    projects = [
        known_project for known_project in corpus() if not given.names or known_project.name in given.names
    ]
    if not given.names:
        projects = sorted(random.Random(1).sample(projects, min(given.projects, len(projects))))
    counts, wrong = Counter[str](), 0
    for project in projects:
        with tempfile.TemporaryDirectory() as name:
            wrong += _judge(project, Path(name).resolve(), given.patches, counts)
    print(", ".join(f"{count} {what}" for what, count in sorted(counts.items())))
    print(f"{wrong} disagree")
    return int(bool(wrong) or not counts["compared"])


def _judge(project: Path, folder: Path, count: int, counts: Counter[str]) -> int:
    """Judge patches of a project; return how many verdicts disagree."""
    whole = copied(project, folder / "whole" / project.name)
    if _plain(whole):
        print(f"{project.name}: its tests do not run alone")
        return 0
    patches = _write_patches(whole, count)
    plain = {patch: _fails_with(whole, patch, folder / "plain") for patch in patches}
    wrong = 0
    for engine in ENGINES:
        copy = folder / engine / project.name
        shutil.copytree(whole, copy)
        found = _campaign(copy, engine)
        for patch, fails in plain.items():
            ours, message = found.get(f"patches/{patch}", ("not run", ""))
            if ours == "error" and _NOT_FORKED in message:
                counts["left to replay"] += 1
                continue
            counts["compared"] += 1
            counts[f"{engine}: {ours}"] += 1
            if (ours in ("killed", "timeout", "refused", "invalid")) != fails or ours in ("error", "not run"):
                wrong += 1
                print(f"{project.name} {patch} [{engine}]: {ours} ({message}); plain pytest {_words(fails)}")
                print((whole / "patches" / patch).read_text())
    print(f"{project.name}: {len(patches)} patches, {sum(plain.values())} of them fail")
    return wrong


def _words(fails: bool) -> str:
    return "fails" if fails else "passes"


def _write_patches(folder: Path, count: int) -> list[str]:
    """Write patches of one to three edits into the project's folder of patches."""
    files = [
        path
        for path in sorted(folder.rglob("*.py"))
        if "tests" not in path.parts and path.name != "conftest.py"
    ]
    draw = random.Random(folder.name)
    (folder / "patches").mkdir()
    names = list[str]()
    edits = {file: list(_edits(file.read_text(encoding="utf-8"))) for file in files}
    every = [(file, edit) for file, found in edits.items() for edit in found]
    for number in range(count):
        chosen = draw.sample(every, min(1 + number % 3, len(every)))
        with tempfile.TemporaryDirectory() as name:
            pair = [Path(name) / side for side in ("a", "b")]
            for side in pair:
                shutil.copytree(folder, side, ignore=shutil.ignore_patterns("patches", "__pycache__"))
            for file in {file for file, _ in chosen}:
                text = file.read_text(encoding="utf-8")
                for start, end, other in _apart(
                    [edit for changed_file, edit in chosen if changed_file == file]
                ):
                    text = text[:start] + other + text[end:]
                (pair[1] / file.relative_to(folder)).write_text(text, encoding="utf-8")
            words = ["git", "diff", "--no-index", "--no-prefix", "a", "b"]
            done = subprocess.run(words, cwd=name, capture_output=True, text=True, check=False)
            if done.stdout:
                names.append(f"{number}.patch")
                (folder / "patches" / names[-1]).write_text(done.stdout, encoding="utf-8")
    return names


def _apart(edits: list[Edit]) -> list[Edit]:
    """Edits that do not overlap, the last first."""
    kept = list[Edit]()
    for edit in sorted(edits, reverse=True):
        if not kept or edit[1] <= kept[-1][0]:
            kept.append(edit)
    return kept


def _edits(text: str) -> Iterator[Edit]:
    """All edits of a text, each a fault as people make it."""
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.expr | ast.stmt) or not text.isascii():
            continue
        start = starts[node.lineno - 1] + node.col_offset
        end = starts[(node.end_lineno or 1) - 1] + (node.end_col_offset or 0)
        source = text[start:end]
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            yield start, end, f"-{source}"
            yield start, end, f"{source} + 1"
        elif isinstance(node, ast.Compare) and type(node.ops[0]) in _COMPARED and len(node.ops) == 1:
            left, right = ast.unparse(node.left), ast.unparse(node.comparators[0])
            yield start, end, f"{left} {_COMPARED[type(node.ops[0])]} {right}"
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            yield start, end, "pass"
        elif isinstance(node, ast.Call) and len(node.args) > 1:
            first, second, *others = map(ast.unparse, node.args)
            keywords = [ast.unparse(keyword) for keyword in node.keywords]
            yield start, end, f"{ast.unparse(node.func)}({', '.join([second, first, *others, *keywords])})"
        elif isinstance(node, ast.Return) and node.value is not None:
            yield start, end, "return None"


def _fails_with(folder: Path, patch: str, to: Path) -> bool:
    """Whether the tests of a copy fail to which git has applied the patch."""
    copy = to / patch / folder.name
    shutil.copytree(folder, copy)
    words = ["git", "apply", f"patches/{patch}"]
    subprocess.run(words, cwd=copy, check=True, env={**os.environ, "GIT_CEILING_DIRECTORIES": str(to)})
    return _plain(copy)


def _plain(folder: Path) -> bool:
    """Whether plain pytest fails, or does not come to an end, on the tests that the project names."""
    settings = tomllib.loads((folder / "mutabot.toml").read_text(encoding="utf-8"))
    words = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
    words += [*settings.get("pytest_args", []), *settings.get("tests", ["tests"])]
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        done = subprocess.run(
            words, cwd=folder, env=environment, capture_output=True, timeout=60, check=False
        )
    except subprocess.TimeoutExpired:
        return True
    return done.returncode != 0


def _campaign(folder: Path, engine: str) -> dict[str, tuple[str, str]]:
    """Verdict and message of each patch."""
    words = [sys.executable, "-m", "mutabot", "run", "--family", "patch", "--engine", engine, "--json"]
    done = subprocess.run(
        [*words, "-o", "evidence=0"], cwd=folder, capture_output=True, text=True, check=False
    )
    try:
        mutants = json.loads(done.stdout)["mutants"]
    except ValueError:
        print(f"{folder.name} [{engine}]: {done.stderr}")
        return {}
    return {
        mutant["description"].partition(" ")[0]: (
            mutant["rounds"][0]["verdict"],
            mutant["rounds"][0]["message"] or "",
        )
        for mutant in mutants
    }


if __name__ == "__main__":
    sys.exit(main())
