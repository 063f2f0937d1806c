"""Plain projects, conventional mutants: what mutabot and irradiate cost, and whether pytest says the same.

Three projects of others come from their source distributions, pinned below, and each tool is installed in a
virtual environment of its own with the same pytest. On a copy of each project both draw as many mutants and
run them in one process at a time. Measured is processor time, of everything that the command starts. Of each
tool's verdicts some survivors and some kills are then made by hand, by editing the text of a copy, and plain
pytest says whether the suite notices. Survivors of mutabot were run to the end of the suite.

The tools have other operators, so their mutants and scores differ; what can be compared is what a mutant
costs and how often a verdict is right.

Use: ``python benchmarks/plain_projects.py [NAME…] [--mutants 60] [--judged 8] [--repeat 1] [--venvs FOLDER]
[--json FILE]``. With ``--venvs`` the environments are kept there and used again. The exit code is 1 if plain
pytest contradicts a verdict of mutabot's.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from random import Random
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests"))

from suites.editor import CannotWriteError, Source, text_edit  # noqa: E402

#: by name: distribution, the program in it, its tests, what it needs
PROJECTS: dict[str, tuple[str, str, str, list[str]]] = {
    "python-slugify": ("python-slugify==9.2.0", "slugify", "tests", ["text-unidecode==1.3"]),
    "inflection": ("inflection==0.5.1", "inflection", "test_inflection.py", []),
    "cachetools": ("cachetools==5.5.0", "src/cachetools", "tests", []),
}
PYTEST, IRRADIATE = "pytest==9.2.0", "irradiate==0.4.3"
#: seconds that plain pytest may take for an edited copy; a suite that hangs notices
_PATIENCE = 60
_NOTICED = {"killed", "timeout", "Killed", "Timeout", "invalid"}
_MISSED = {"survived", "Survived", "no effect"}


@dataclass
class Figures:
    """What one tool did with one project."""

    cpu: float
    mutants: int
    killed: int
    survived: int
    right: int = 0
    wrong: list[str] = field(default_factory=list)
    unwritable: int = 0


@dataclass(frozen=True)
class Judged:
    """A mutant with its verdict, and how to write it: the file and its new bytes."""

    name: str
    verdict: str
    write: Callable[[], tuple[str, bytes]]


def main() -> int:
    """Run both tools on the projects and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", default=list(PROJECTS), help="projects; default all")
    parser.add_argument("--mutants", type=int, default=60)
    parser.add_argument(
        "--judged", type=int, default=8, help="survivors, and kills, of each tool that pytest judges"
    )
    parser.add_argument("--repeat", type=int, default=1, help="the least of so many campaigns counts")
    parser.add_argument("--venvs", type=Path, help="keep the environments in this folder")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    given = parser.parse_args()
    found: dict[str, dict[str, Any]] = {}
    with tempfile.TemporaryDirectory() as folder:
        venvs = given.venvs.resolve() if given.venvs else Path(folder, "venvs")
        needs = [need for *_, more in PROJECTS.values() for need in more]
        ours = _environment(venvs / "mutabot", [str(HERE.parent), PYTEST, *needs])
        theirs = _environment(venvs / "irradiate", [IRRADIATE, PYTEST, *needs])
        here = [ours, "-m", "pip", "install", "-q", "--no-deps", "--force-reinstall", str(HERE.parent)]
        subprocess.run(here, check=True)  # an environment that was kept has an older one
        for name in given.names:
            project = _project(name, Path(folder, name))
            suite, done = min((_cpu([theirs, "-m", "pytest", "-q"], project) for _ in range(3)), key=_seconds)
            if done.returncode:
                raise SystemExit(f"{name}: plain pytest fails: {done.stdout[-2000:]}")
            tools = {"mutabot": (_mutabot, ours), "irradiate": (_irradiate, theirs)}
            found[name] = {"pytest": round(suite, 2)}
            for tool, (run, python) in tools.items():
                figures, judged = min(
                    (run(python, project, given.mutants) for _ in range(given.repeat)),
                    key=lambda one: one[0].cpu,
                )
                for one in _drawn(judged, given.judged):
                    _judge(theirs, project, one, figures)
                found[name][tool] = asdict(figures)
                _print(name, suite, tool, figures)
    if given.json:
        given.json.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    return int(any(one["mutabot"]["wrong"] for one in found.values()))


def _seconds(done: tuple[float, Any]) -> float:
    return done[0]


def _environment(folder: Path, needs: list[str]) -> str:
    """The Python of a virtual environment with these packages, made if it is not there."""
    python = folder / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        subprocess.run([python, "-m", "pip", "install", "-q", *needs], check=True)
    return str(python)


def _project(name: str, folder: Path) -> Path:
    """The project from its source distribution, told where its program and its tests are."""
    requirement, program, tests, _ = PROJECTS[name]
    folder.mkdir()
    command = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--no-binary", ":all:"]
    subprocess.run([*command, "-d", folder, requirement], check=True)
    (archive,) = folder.glob("*.tar.gz")
    with tarfile.open(archive) as tar:
        tar.extractall(folder, filter="data")
    (root,) = (path for path in folder.iterdir() if path.is_dir())
    project = root.rename(folder / "project")
    (project / "pytest.ini").write_text(
        f"[pytest]\ntestpaths = {tests}\npythonpath = . {Path(program).parent}\n"
    )
    (project / "mutabot.toml").write_text(
        f'program = ["{program}"]\ntests = ["{tests}"]\nfamilies = ["conventional"]\n'
    )
    return project


def _cpu(command: list[str], folder: Path) -> tuple[float, subprocess.CompletedProcess[str]]:
    """Processor seconds of a command and of all that it waited for, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, env=environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done


def _copy(project: Path, name: str) -> Path:
    copy = project.with_name(name)
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(project, copy)
    return copy


def _mutabot(python: str, project: Path, mutants: int) -> tuple[Figures, list[Judged]]:
    copy = _copy(project, "mutabot")
    command = [python, "-m", "mutabot.cli.app", "run", "--sample", str(mutants), "-j", "1", "--json"]
    cpu, done = _cpu(command, copy)
    if done.returncode:
        raise SystemExit(f"mutabot: exit code {done.returncode}: {done.stderr[-2000:]}")
    found = json.loads(done.stdout)["mutants"]

    def writer(mutant: dict[str, Any]) -> Callable[[], tuple[str, bytes]]:
        def write() -> tuple[str, bytes]:
            source = Source(project / mutant["file"], mutant["file"])
            return mutant["file"], text_edit(source, mutant).applied(source.bytes)

        return write

    judged = [Judged(one["id"], one["rounds"][0]["verdict"], writer(one)) for one in found if one["rounds"]]
    return _figures(cpu, judged), judged


def _irradiate(python: str, project: Path, mutants: int) -> tuple[Figures, list[Judged]]:
    copy = _copy(project, "irradiate")
    _, program, tests, _ = PROJECTS[project.parent.name]
    command = [str(Path(python).with_name("irradiate")), "run", program, "--tests-dir", tests]
    command += ["--python", python, "--workers", "1", "--sample", str(mutants)]
    command += ["--no-cache", "--report", "json", "-o", "report.json"]
    cpu, done = _cpu(command, copy)
    report = copy / "report.json"
    if not report.exists():
        raise SystemExit(
            f"irradiate: exit code {done.returncode}: {done.stdout[-2000:]}{done.stderr[-2000:]}"
        )
    # it names files from the folder of the package, and has no text of them if that is not the project's own
    files = [str(path.relative_to(project)) for path in (project / program).rglob("*.py")]
    place = {str(Path(file).relative_to(Path(program).parent)): file for file in files}
    judged = [
        Judged(one["id"], one["status"], _written_by_location(project, place.get(file, file), one))
        for file, found in json.loads(report.read_text())["files"].items()
        for one in found["mutants"]
    ]
    return _figures(cpu, judged), judged


def _written_by_location(project: Path, file: str, mutant: dict[str, Any]) -> Callable[[], tuple[str, bytes]]:
    """A mutant as the report format of Stryker tells it: all counted from 1, the end behind the last."""

    def write() -> tuple[str, bytes]:
        source = (project / file).read_text(encoding="utf-8")
        lines = source.splitlines(keepends=True)
        first, last = mutant["location"]["start"], mutant["location"]["end"]
        start = sum(map(len, lines[: first["line"] - 1])) + first["column"] - 1
        end = sum(map(len, lines[: last["line"] - 1])) + last["column"] - 1
        return file, (source[:start] + mutant["replacement"] + source[end:]).encode()

    return write


def _figures(cpu: float, judged: list[Judged]) -> Figures:
    killed = sum(one.verdict in _NOTICED for one in judged)
    survived = sum(one.verdict in _MISSED for one in judged)
    return Figures(round(cpu, 1), len(judged), killed, survived)


def _drawn(judged: list[Judged], count: int) -> Iterator[Judged]:
    """Some survivors and some kills, always the same ones."""
    for verdicts in (_MISSED, _NOTICED):
        some = sorted((one for one in judged if one.verdict in verdicts), key=lambda one: one.name)
        yield from Random(1).sample(some, min(count, len(some)))


def _judge(python: str, project: Path, mutant: Judged, figures: Figures) -> None:
    """Ask plain pytest about an edited copy."""
    try:
        file, text = mutant.write()
        compile(text, file, "exec")
    except (CannotWriteError, SyntaxError):
        figures.unwritable += 1
        return
    copy = _copy(project, "edited")
    (copy / file).write_bytes(text)
    shutil.copy(HERE.parent / "tests" / "suites" / "planted.py", copy / "_planted.py")
    command = [python, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
    try:
        notices = bool(
            subprocess.run(command, cwd=copy, capture_output=True, timeout=_PATIENCE, check=False).returncode
        )
    except subprocess.TimeoutExpired:
        notices = True
    if notices == (mutant.verdict in _NOTICED):
        figures.right += 1
    else:
        said = f"{mutant.name}: {mutant.verdict}, but plain pytest {'fails' if notices else 'passes'}"
        figures.wrong.append(said)


def _print(name: str, suite: float, tool: str, figures: Figures) -> None:
    judged = figures.right + len(figures.wrong)
    print(
        f"{name:15} {tool:10} {figures.cpu:6.1f} s, suite {suite:.1f} s: {figures.mutants} mutants, "
        f"{figures.killed} killed, {figures.survived} survived; plain pytest agrees with "
        f"{figures.right} of {judged}, {figures.unwritable} cannot be written",
        flush=True,
    )
    for wrong in figures.wrong:
        print(f"    {wrong}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
