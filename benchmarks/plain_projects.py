"""Plain projects, conventional mutants: what mutabot and two others cost, and whether pytest says the same.

Projects of others come from their source distributions, pinned below, and each tool is installed in a virtual
environment of its own with the same pytest. On a copy of each project all draw as many mutants and run them
in one process at a time. Measured is processor time, of everything that the command starts. Of each tool's
verdicts some survivors and some kills are then made by hand, by editing the text of a copy, and plain pytest
says whether the suite notices.

The tools have other operators, so their mutants and scores differ; what can be compared is what a verdict
costs and how often one is right. moonbuggy draws no sample: it is given one by its own functions, which its
command calls. It needs Python 3.12, and is left out below that. Each project keeps its own pytest settings.

Use: ``python benchmarks/plain_projects.py [NAME…] [--tools TOOL…] [--mutants 60] [--judged 8] [--judge TOOL…]
[--repeat 1] [--in-functions] [--venvs FOLDER] [--sources FOLDER] [--json FILE]``. With
``--in-functions`` mutabot's mutants are drawn from those in functions, as irradiate's are: one at module
level is active while the program is imported, and all tests judge it. With ``--venvs`` the environments are
kept there and used again. A distribution without tests is left out, unless there is a checkout under its
name in ``--sources``, which is then used instead of a distribution.
The exit code is 1 if plain pytest contradicts a verdict of mutabot's.
"""

from __future__ import annotations

import argparse
import ast
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
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests"))

from suites.editor import CannotWriteError, Source, text_edit  # noqa: E402


@dataclass(frozen=True)
class Project:
    """A project: its version, the program in it, its tests, what these need, and options of pytest.

    Attributes:
        options: added to those in the project's own settings.
        has_tests: whether its source distribution has its tests.
    """

    version: str
    program: str
    tests: str = "tests"
    needs: tuple[str, ...] = ()
    options: str = ""
    has_tests: bool = True


PROJECTS = {
    "python-slugify": Project("9.2.0", "slugify", needs=("text-unidecode==1.3",)),
    "inflection": Project("0.5.1", "inflection", "test_inflection.py"),
    "cachetools": Project("5.5.0", "src/cachetools"),
    "humanize": Project("4.17.0", "src/humanize", needs=("freezegun==1.5.5",),
                        options="--ignore=tests/test_benchmarks.py"),
    "tomlkit": Project("0.15.2", "tomlkit", needs=("PyYAML==6.0.4",)),
    "boltons": Project("26.2.0", "boltons"),
    "packaging": Project("25.0", "src/packaging", needs=("pretend==1.0.9", "tomli_w==1.2.0")),
    "sortedcontainers": Project("2.4.0", "sortedcontainers", has_tests=False),
}  # fmt: skip
TOOLS = {"mutabot": str(HERE.parent), "irradiate": "irradiate==0.4.3", "moonbuggy": "moonbuggy==0.2.0"}
PYTEST = "pytest==9.2.0"
#: what moonbuggy's command does with all of its mutants, done with some of them, drawn at random
_MOONBUGGY = """
import json, random, sys
from pathlib import Path
from moonbuggy.generate import generate_mutants
from moonbuggy.inmemory import mutated_source
from moonbuggy.report import record_for
from moonbuggy.runner import run_session
from moonbuggy.srcio import read_source
program, mutants, timeout = Path(sys.argv[1]).resolve(), int(sys.argv[2]), float(sys.argv[3])
every = [one for file in sorted(program.rglob("*.py"))
         for one in generate_mutants(read_source(file), module=str(file.relative_to(Path.cwd())))]
drawn = random.Random(0).sample(every, min(mutants, len(every)))
_, results = run_session(Path.cwd(), drawn, program, timeout, jobs=1)
text = lambda one: mutated_source(one.module, one.line, one.mutated)
print(json.dumps([{**record_for(one), "text": text(one.mutant)} for one in results]))
"""
#: seconds that a mutant may take, by moonbuggy; of plain pytest for an edited copy: of a processor at least,
#: and ten times as many by the clock, since the machine may be busy. A suite that hangs notices
_PATIENCE = 60
_NOTICED = {"killed", "timeout", "Killed", "Timeout", "invalid", "KILLED", "KILLED_BY_ERROR", "TIMEOUT"}
_NOT_REACHED = {"not covered", "NoCoverage", "NO_COVERAGE"}
_MISSED = {"survived", "Survived", "no effect", "SURVIVED", *_NOT_REACHED}


@dataclass
class Figures:
    """What one tool did with one project."""

    cpu: float
    mutants: int
    killed: int
    survived: int
    right: int = 0
    wrong: list[str] = field(default_factory=list)
    #: processor time of each campaign
    every: list[float] = field(default_factory=list)
    unwritable: int = 0


class ToolError(Exception):
    """A tool has no verdicts on a project; the message says why."""


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
    parser.add_argument("--tools", nargs="+", default=list(TOOLS), choices=TOOLS)
    parser.add_argument("--mutants", type=int, default=60)
    parser.add_argument(
        "--judged", type=int, default=8, help="survivors, and kills, of each tool that pytest judges"
    )
    parser.add_argument("--judge", nargs="+", default=list(TOOLS), choices=TOOLS, help="whose verdicts")
    parser.add_argument("--repeat", type=int, default=1, help="campaigns of each tool, one after another")
    parser.add_argument(
        "--in-functions", action="store_true", help="draw mutabot's mutants from those in functions"
    )
    parser.add_argument("--venvs", type=Path, help="keep the environments in this folder")
    parser.add_argument("--sources", type=Path, help="folder with checkouts of projects")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    given = parser.parse_args()
    found: dict[str, dict[str, Any]] = {}
    with tempfile.TemporaryDirectory() as folder:
        venvs = given.venvs.resolve() if given.venvs else Path(folder, "venvs")
        pythons = {tool: _environment(venvs / tool, tool) for tool in given.tools}
        for name in given.names:
            project = _project(name, Path(folder, name), given.sources)
            if project is None:
                print(f"{name}: its distribution has no tests; give a checkout in --sources")
                continue
            found[name] = _compare(project, PROJECTS[name], pythons, given)
    if given.json:
        given.json.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    return int(any(figures.get("mutabot", {}).get("wrong") for figures in found.values()))


def _compare(
    folder: Path, project: Project, pythons: dict[str, str], given: argparse.Namespace
) -> dict[str, Any]:
    """What the tools did with one project. They take turns; of each the cheapest campaign counts."""
    name = folder.parent.name
    python = next(iter(pythons.values()))
    command = [python, "-m", "pytest", "-q", project.tests]
    suite, done = min((_cpu(command, folder, project) for _ in range(given.repeat)), key=_seconds)
    if done.returncode:
        raise SystemExit(f"{name}: plain pytest fails: {done.stdout[-2000:]}")
    runs: dict[str, list[tuple[Figures, list[Judged]]]] = {tool: [] for tool in pythons}
    for _ in range(given.repeat):
        for tool, campaigns in runs.items():
            try:
                run = _mutabot_in_functions if tool == "mutabot" and given.in_functions else _RUNS[tool]
                campaigns.append(run(pythons[tool], folder, project, given.mutants))
            except ToolError as error:
                print(f"{name}: {tool} {error}", flush=True)
    found: dict[str, Any] = {"pytest": round(suite, 2)}
    for tool, campaigns in runs.items():
        if campaigns:
            figures, judged = min(campaigns, key=lambda campaign: campaign[0].cpu)
            figures.every = [facts.cpu for facts, _ in campaigns]
            for chosen in _drawn(judged, given.judged if tool in given.judge else 0):
                _judge(python, folder, project, chosen, figures, suite)
            found[tool] = asdict(figures)
            _print(name, suite, tool, figures)
    return found


def _seconds(done: tuple[float, Any]) -> float:
    return done[0]


def _environment(folder: Path, tool: str) -> str:
    """The Python of a virtual environment with this tool and what the projects need."""
    python = str(folder / "bin" / "python")
    install = [python, "-m", "pip", "install", "-q"]
    if not Path(python).exists():
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        needs = [need for project in PROJECTS.values() for need in project.needs]
        done = subprocess.run([*install, TOOLS[tool], PYTEST, *needs], check=False)
        if done.returncode:
            raise SystemExit(f"{tool} cannot be installed by Python {sys.version.split()[0]}")
    if tool == "mutabot":  # an environment that was kept has an older one
        subprocess.run([*install, "--no-deps", "--force-reinstall", TOOLS[tool]], check=True)
    return python


def _project(name: str, folder: Path, sources: Path | None) -> Path | None:
    """The project from its source distribution or checkout, told where its program and its tests are."""
    it = PROJECTS[name]
    folder.mkdir()
    project = folder / "project"
    if sources and (sources / name).is_dir():
        shutil.copytree(sources / name, project, ignore=shutil.ignore_patterns(".git"))
    elif it.has_tests:
        command = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--no-binary", ":all:"]
        subprocess.run([*command, "-d", folder, f"{name}=={it.version}"], check=True)
        (archive,) = folder.glob("*.tar.gz")
        with tarfile.open(archive) as tar:
            tar.extractall(folder, filter="data")
        (root,) = (path for path in folder.iterdir() if path.is_dir())
        root.rename(project)
    else:
        return None
    (project / "mutabot.toml").write_text(
        f'program = ["{it.program}"]\ntests = ["{it.tests}"]\nfamilies = ["conventional"]\n'
    )
    return project


def _environment_of(python: str, folder: Path, project: Project) -> dict[str, str]:
    """The environment in which the program is imported from this copy of the project."""
    found = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1", "PYTEST_ADDOPTS": project.options}
    found["PYTHONPATH"] = os.pathsep.join([str((folder / project.program).parent), str(folder)])
    found["PATH"] = f"{Path(python).parent}:{found['PATH']}"
    return found


def _cpu(
    command: list[str], folder: Path, project: Project
) -> tuple[float, subprocess.CompletedProcess[str]]:
    """Processor seconds of a command and of all that it waited for, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = _environment_of(command[0], folder, project)
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, env=environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done


def _copy(project: Path, name: str) -> Path:
    copy = project.with_name(name)
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(project, copy)
    return copy


def _mutabot(python: str, folder: Path, project: Project, mutants: int) -> tuple[Figures, list[Judged]]:
    return _mutabot_of(python, folder, project, ["--sample", str(mutants)])


def _mutabot_in_functions(
    python: str, folder: Path, project: Project, mutants: int
) -> tuple[Figures, list[Judged]]:
    """The same with mutants in functions only; to draw them is not counted."""
    _, done = _cpu([python, "-m", "mutabot.cli.app", "list", "--json"], _copy(folder, "listed"), project)
    if done.returncode:
        raise ToolError(f"lists no mutants: {done.stderr[-2000:]}")
    every = [mutant["id"] for mutant in json.loads(done.stdout)["mutants"] if _is_in_function(folder, mutant)]
    drawn = Random(0).sample(every, min(mutants, len(every)))
    return _mutabot_of(python, folder, project, [word for name in drawn for word in ("--only", name)])


def _is_in_function(folder: Path, mutant: dict[str, Any]) -> bool:
    tree, line = _tree(folder / mutant["file"]), mutant["span"]["line"]
    functions = (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef))
    return any(node.body[0].lineno <= line <= (node.end_lineno or 0) for node in functions)


@cache
def _tree(file: Path) -> ast.Module:
    return ast.parse(file.read_bytes())


def _mutabot_of(
    python: str, folder: Path, project: Project, which: list[str]
) -> tuple[Figures, list[Judged]]:
    copy = _copy(folder, "mutabot")
    command = [python, "-m", "mutabot.cli.app", "run", *which, "-j", "1", "--json"]
    cpu, done = _cpu(command, copy, project)
    if done.returncode:
        raise ToolError(f"ends with exit code {done.returncode}: {done.stderr[-2000:]}")
    found = json.loads(done.stdout)["mutants"]

    def writer(mutant: dict[str, Any]) -> Callable[[], tuple[str, bytes]]:
        def write() -> tuple[str, bytes]:
            source = Source(folder / mutant["file"], mutant["file"])
            return mutant["file"], text_edit(source, mutant).applied(source.bytes)

        return write

    judged = [
        Judged(mutant["id"], mutant["rounds"][0]["verdict"], writer(mutant))
        for mutant in found
        if mutant["rounds"]
    ]
    return _figures(cpu, judged), judged


def _irradiate(python: str, folder: Path, project: Project, mutants: int) -> tuple[Figures, list[Judged]]:
    copy = _copy(folder, "irradiate")
    program = project.program
    command = [str(Path(python).with_name("irradiate")), "run", program, "--tests-dir", project.tests]
    command += ["--python", python, "--workers", "1", "--sample", str(mutants)]
    command += ["--worker-timeout", "300", "--stats-timeout", "900"]
    command += ["--no-cache", "--report", "json", "-o", "report.json"]
    cpu, done = _cpu(command, copy, project)
    report = copy / "report.json"
    if not report.exists():
        raise ToolError(f"ends with exit code {done.returncode}: {done.stdout[-2000:]}{done.stderr[-2000:]}")
    # it names files from the folder of the package, and has no text of them if that is not the project's own
    files = [str(path.relative_to(folder)) for path in (folder / program).rglob("*.py")]
    place = {str(Path(file).relative_to(Path(program).parent)): file for file in files}
    judged = [
        Judged(mutant["id"], mutant["status"], _written_by_location(folder, place.get(file, file), mutant))
        for file, found in json.loads(report.read_text())["files"].items()
        for mutant in found["mutants"]
    ]
    return _figures(cpu, judged), judged


def _moonbuggy(python: str, folder: Path, project: Project, mutants: int) -> tuple[Figures, list[Judged]]:
    copy = _copy(folder, "moonbuggy")
    command = [python, "-c", _MOONBUGGY, project.program, str(mutants), str(_PATIENCE)]
    cpu, done = _cpu(command, copy, project)
    if done.returncode:
        raise ToolError(f"ends with exit code {done.returncode}: {done.stderr[-2000:]}")

    def writer(mutant: dict[str, Any]) -> Callable[[], tuple[str, bytes]]:
        return lambda: (mutant["file"], mutant["text"].encode())

    found = json.loads(done.stdout.splitlines()[-1])
    judged = [Judged(mutant["id"], mutant["status"], writer(mutant)) for mutant in found]
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


_RUNS = {"mutabot": _mutabot, "irradiate": _irradiate, "moonbuggy": _moonbuggy}


def _figures(cpu: float, judged: list[Judged]) -> Figures:
    killed = sum(verdict.verdict in _NOTICED for verdict in judged)
    survived = sum(verdict.verdict in _MISSED for verdict in judged)
    return Figures(round(cpu, 1), len(judged), killed, survived)


def _drawn(judged: list[Judged], count: int) -> Iterator[Judged]:
    """Some survivors and some kills, always the same ones; what no test reaches only if there are too few."""
    for verdicts in (_MISSED, _NOTICED):
        some = sorted(
            (verdict for verdict in judged if verdict.verdict in verdicts), key=lambda verdict: verdict.name
        )
        Random(1).shuffle(some)
        yield from sorted(some, key=lambda verdict: verdict.verdict in _NOT_REACHED)[:count]


def _judge(
    python: str, folder: Path, project: Project, mutant: Judged, figures: Figures, suite: float
) -> None:
    """Ask plain pytest about an edited copy."""
    try:
        file, text = mutant.write()
        compile(text, file, "exec")
    except (CannotWriteError, SyntaxError):
        figures.unwritable += 1
        return
    copy = _copy(folder, "edited")
    (copy / file).write_bytes(text)
    shutil.copy(HERE.parent / "tests" / "suites" / "planted.py", copy / "_planted.py")
    command = [python, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", project.tests]
    environment = _environment_of(python, copy, project)
    patience = round(max(_PATIENCE, 20 * suite))
    command = ["prlimit", f"--cpu={patience}", *command]
    try:
        done = subprocess.run(
            command, cwd=copy, capture_output=True, timeout=10 * patience, check=False, env=environment
        )
        notices = bool(done.returncode)
    except subprocess.TimeoutExpired:
        notices = True
    if notices == (mutant.verdict in _NOTICED):
        figures.right += 1
    else:
        said = f"{mutant.name}: {mutant.verdict}, but plain pytest {'fails' if notices else 'passes'}"
        figures.wrong.append(said)


def _print(name: str, suite: float, tool: str, figures: Figures) -> None:
    judged = figures.right + len(figures.wrong)
    verdicts = figures.killed + figures.survived
    print(
        f"{name:16} {tool:10} {' '.join(map(str, figures.every))} s, suite {suite:.1f} s: {figures.killed} "
        f"killed and {figures.survived} survived of {figures.mutants}, "
        f"{figures.cpu / max(verdicts, 1):.2f} s a verdict; plain pytest agrees with "
        f"{figures.right} of {judged}, {figures.unwritable} cannot be written",
        flush=True,
    )
    for wrong in figures.wrong:
        print(f"    {wrong}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
