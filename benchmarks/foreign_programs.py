"""The recipes of docs/recipes on programs that use robot libraries of others: init, check, run, and a judge.

Each page holds a whole project: every block that begins with a file's name is that file. In a temporary
folder `mutabot init`, `check` and `run` do what the page says, with no help; then some mutants are made by
hand, by editing the text of a copy, and plain pytest says whether the tests notice. Printed are the mutants,
the verdicts, the score, the seconds, and whether the hand-made mutants agree.

Use: ``make foreign``, or ``python benchmarks/foreign_programs.py [NAME…] [--json FILE]`` in an environment
with the packages of ``tools/shipped.txt``. The exit code is 1 if a command fails or a verdict disagrees.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from shutil import copytree, ignore_patterns
from typing import Any

PAGES = Path(__file__).parents[1] / "docs" / "recipes"
_BLOCK = re.compile(r"```(?:python|toml)\n# (\S+\.(?:py|toml))\n(.*?)```", re.DOTALL)
RECIPES: dict[str, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
_KILLED, _SURVIVED = ("killed", "timeout"), ("survived",)


def main() -> int:
    """Run the recipes and print what came of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", default=list(RECIPES), help="pages; default all")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    given = parser.parse_args()
    figures = {}
    for name in given.names:
        with tempfile.TemporaryDirectory() as folder:
            figures[name] = _try(name, RECIPES[name], Path(folder) / "project")
    if given.json:
        given.json.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
    return int(any(figure["failed"] or figure["disagree"] for figure in figures.values()))


def files_of(page: Path) -> dict[str, str]:
    """The files of the project, by name: those on a page, and those in the folder beside it."""
    folder = page.with_suffix("")
    beside = {str(path.relative_to(folder)): path.read_text("utf-8") for path in folder.rglob("*.py")}
    return beside | {match[1]: match[2] for match in _BLOCK.finditer(page.read_text(encoding="utf-8"))}


def write_project(name: str, folder: Path) -> None:
    """Write the files of a recipe's project."""
    for file, text in files_of(PAGES / f"{name}.md").items():
        path = folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def _try(name: str, recipe: dict[str, Any], folder: Path) -> dict[str, Any]:
    write_project(name, folder)
    print(f"{name}: {', '.join(sorted(path.name for path in folder.rglob('*.py')))}")
    figures: dict[str, Any] = {"seconds": {}, "failed": [], "disagree": []}
    plain = time.monotonic()
    if _pytest(folder):
        figures["failed"].append("plain pytest")
    figures["seconds"]["pytest"] = round(time.monotonic() - plain, 1)
    for words in (["init"], ["check"], ["run", "--json"]):
        started = time.monotonic()
        done = run_mutabot(folder, *words)
        figures["seconds"][words[0]] = round(time.monotonic() - started, 1)
        if done.returncode:
            figures["failed"].append(f"{words[0]}: exit code {done.returncode}: {done.stderr[-500:]}")
            print(f"  {figures['failed'][-1]}")
            return figures
    results = json.loads(done.stdout)
    mutants = results["mutants"]
    verdicts = Counter(_verdict(mutant) for mutant in mutants)
    groups = {f"{group['family']} {group['role']}": group["score"] for group in results["groups"]}
    figures |= {"mutants": len(mutants), "verdicts": dict(verdicts), "scores": groups}
    figures["judged"] = list(_judge(folder, recipe, mutants))
    figures["disagree"] = [verdict for verdict in figures["judged"] if not verdict["agree"]]
    _print(figures)
    return figures


def _judge(folder: Path, recipe: dict[str, Any], mutants: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Each hand-made mutant: what plain pytest says of it, and what the campaign did."""
    program = recipe["program"]
    text = (folder / program).read_text(encoding="utf-8")
    lines = text.splitlines()
    for edit in recipe["edit"]:
        found = [
            mutant
            for mutant in mutants
            if mutant["file"] == program
            and mutant["operator"] == edit["operator"]
            and mutant["quantity"] == edit.get("quantity")
            and edit["line"] in lines[mutant["span"]["line"] - 1]
        ]
        if not found or edit["old"] not in text:
            yield {"edit": edit, "agree": False, "why": "not found"}
            continue
        copy = folder.with_name("edited")
        copytree(folder, copy, ignore=ignore_patterns(".mutabot", "__pycache__", ".pytest_cache"))
        (copy / program).write_text(text.replace(edit["old"], edit["new"], 1), encoding="utf-8")
        fails = _pytest(copy) != 0
        _remove(copy)
        verdict = _verdict(found[0])
        agree = verdict in (_KILLED if fails else _SURVIVED) or (fails and verdict == "refused")
        yield {
            "mutant": found[0]["id"], "description": found[0]["description"], "verdict": verdict,
            "pytest": "fails" if fails else "passes", "agree": agree,
        }  # fmt: skip


def _verdict(mutant: dict[str, Any]) -> str:
    return str(mutant["rounds"][0]["verdict"])


def _print(figures: dict[str, Any]) -> None:
    seconds = ", ".join(f"{name} {spent} s" for name, spent in figures["seconds"].items())
    verdicts = ", ".join(f"{count} {verdict}" for verdict, count in figures["verdicts"].items())
    scores = ", ".join(
        f"{name} {score:.1%}" for name, score in figures["scores"].items() if score is not None
    )
    print(f"  {seconds}\n  {figures['mutants']} mutants: {verdicts}; {scores}")
    for ended in figures["judged"]:
        said = f"{ended.get('verdict', ended.get('why'))}, by hand: pytest {ended.get('pytest', '-')}"
        word = "agrees" if ended["agree"] else "DISAGREES"
        print(f"  {word} {said}: {ended.get('description', ended.get('edit'))}")


def run_mutabot(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a command on a project."""
    command = [sys.executable, "-m", "mutabot.cli.app", "-C", str(folder), *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def _pytest(folder: Path) -> int:
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
    return subprocess.run(command, cwd=folder, capture_output=True, check=False).returncode


def _remove(folder: Path) -> None:
    for path in sorted(folder.rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() else path.unlink()
    folder.rmdir()


if __name__ == "__main__":
    sys.exit(main())
