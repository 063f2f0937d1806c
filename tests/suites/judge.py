"""The third judge: plain pytest on a copy of a project whose source text was edited.

It knows nothing of Mutabot. In the folder ``tests``, ``python -m suites.judge PROJECT MUTANT.json`` prints
what plain pytest says about one mutant, given as the object that ``mutabot list --json`` prints for it.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from ros2_domain import domain

from .editor import CannotWriteError, Edit, Facts
from .message_editor import edits_of, is_named, noting_refusals

HERE = Path(__file__).resolve().parent
#: what stands beside a copy, with an underscore before its name
PLANTED = (
    HERE / "planted.py",
    HERE / "planted_messages.py",
    HERE / "planted_graded.py",
    HERE / "planted_catalogue.py",
)
IGNORED = shutil.ignore_patterns(".mutabot", "__pycache__", ".pytest_cache", "judge.toml")
SEEDS = """
import json, os, pytest

@pytest.fixture
def mutabot_seed(request):
    return json.loads(os.environ["JUDGE_SEEDS"]).get(request.node.nodeid, 0)

def pytest_collection_modifyitems(items):
    first = os.environ.get("JUDGE_FIRST")
    items.sort(key=lambda item: item.nodeid != first)
"""
NOTING = """

def _judge_notes(kind):
    import os, sys
    init = kind.__init__
    file, first, last = os.environ["JUDGE_PLACE"].split("|")
    def noted(self, *given, **named):
        init(self, *given, **named)
        frame = sys._getframe()
        while file and frame is not None:
            if frame.f_code.co_filename.endswith("/" + file) and int(first) <= frame.f_lineno <= int(last):
                break
            frame = frame.f_back
        if frame is not None:
            with open(os.environ["JUDGE_NOTES"], "a") as notes:
                notes.write("refused\\n")
    kind.__init__ = noted

_judge_notes({name})
"""
_SUMMARY = re.compile(r"^(?:FAILED|ERROR|SUBFAILED(?:\([^)]*\))?(?:\[[^\]]*\])?) (.+?)(?: - .*)?$")
#: what pytest writes above each failure
_HEADING = re.compile(r"^_{3,} .+ _{3,}$", re.MULTILINE)
#: draws of noise that must all end alike; more where an engine says something else
DRAWS = 3
MORE_DRAWS = 12


@dataclass(frozen=True)
class Judgement:
    """What plain pytest says.

    Attributes:
        state: ``passes``, ``fails``, ``hangs``, or ``unwritable`` with the reason in ``text``.
        tests: the tests that fail, in the order of pytest's summary.
        refused: whether the robot refused the mutated call more often than on the original; with a mutant of
            the program text, any call.
        text: the end of pytest's output.
        seconds: what it took.
    """

    state: str
    tests: tuple[str, ...] = ()
    refused: bool = False
    text: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Judge:
    """Judges the mutants of one project.

    Where ``judge.toml`` says ``independent = true``, a run ends at the first test that fails, and begins with
    the one that is told.

    Attributes:
        folder: the project.
        limit: seconds after which a run counts as hanging.
        seeds: what the fixture ``mutabot_seed`` gives, by test.
        cache: folder that keeps judgements by their input, or None.
    """

    folder: Path
    limit: float = 30.0
    seeds: Mapping[str, int] | None = None
    cache: Path | None = None

    def original(self) -> Judgement:
        """The project as it is."""
        return self._run([])

    def mutant(
        self,
        mutant: Mapping[str, Any],
        *,
        look_for_refusals: bool = False,
        draws: int = DRAWS,
        first: str | None = None,
    ) -> Judgement:
        """One mutant; with noise, only if several draws say the same. ``first``: a test that may fail."""
        try:
            edits = edits_of(Facts.of(self.folder), mutant)
        except CannotWriteError as error:
            return Judgement("unwritable", text=str(error))
        if is_drawn(mutant):
            drawn = []
            for draw in range(1, draws + 1):
                drawn.append(self._run(edits, noise=draw, first=first))
                if drawn[-1].state != drawn[0].state:
                    return Judgement("unwritable", text="draws end differently")
            return drawn[0]
        if is_named(mutant):
            noting = [*edits, *noting_refusals(Facts.of(self.folder))]
            runs = [self._run(noting, noise=run) for run in range(1, (draws if is_raced(mutant) else 1) + 1)]
            if len({run.state for run in runs}) > 1:
                return Judgement("unwritable", text="equal runs end differently")
            return runs[0]
        found = self._run(edits, first=first)
        if not look_for_refusals or _is_of_reading(mutant):
            return found
        span = mutant["span"]
        place = f"{mutant['file']}|{span['line']}|{span['end_line']}" if mutant["operation"] else "||"
        if not self._refusals_are_ours():
            return replace(found, refused=self._names_a_refusal(found.text, mutant))
        before, after = self._notes([], place), self._notes(edits, place)
        if before and before == after:  # whether it is the mutated call that is refused cannot be counted
            return Judgement("unwritable", text="the robot refuses the original there as well")
        return replace(found, refused=after > before)

    def _refusals_are_ours(self) -> bool:
        """Whether the project itself defines all exceptions by which its robot refuses."""
        files = [name.partition(":")[0].replace(".", "/") for name in Facts.of(self.folder).refusals]
        return all((self.folder / f"{file}.py").is_file() for file in files)

    def _names_a_refusal(self, output: str, mutant: Mapping[str, Any]) -> bool:
        """Whether each test that fails ends in a refusal, whose traceback goes through the mutated call."""
        names = [name.rpartition(":")[2].rpartition(".")[2] for name in Facts.of(self.folder).refusals]
        lines = range(mutant["span"]["line"], mutant["span"]["end_line"] + 1)
        places = [rf"^{re.escape(mutant['file'])}:{line}: in " for line in lines]

        def is_one(failure: str) -> bool:
            refused = any(re.search(rf"^E .*\b{name}\b", failure, re.MULTILINE) for name in names)
            is_there = any(re.search(place, failure, re.MULTILINE) for place in places)
            return refused and (is_there or not mutant["operation"])

        failures = _HEADING.split(output)
        return all(map(is_one, failures[1:] or failures))

    def _notes(self, edits: Sequence[Edit], place: str) -> int:
        """How often the robot refused, under the lines of ``place`` only."""
        with tempfile.TemporaryDirectory() as name:
            copy = self._copied(Path(name), edits)
            for refusal in Facts.of(self.folder).refusals:
                module, _, kind = refusal.partition(":")
                file = copy / f"{module.replace('.', '/')}.py"
                if file.is_file():
                    with file.open("a", encoding="utf-8") as end:
                        end.write(NOTING.format(name=kind))
            notes = Path(name) / "notes"
            notes.touch()
            self._pytest(copy, {"JUDGE_NOTES": str(notes), "JUDGE_PLACE": place})
            return notes.read_text().count("refused")

    def _run(self, edits: Sequence[Edit], noise: int = 1, first: str | None = None) -> Judgement:
        is_independent = Facts.of(self.folder).hints.get("independent", False)
        first = first if is_independent else None
        kept = self._kept((edits, noise, first, dict(self.seeds or {})))
        if kept is not None and kept.is_file():
            data = json.loads(kept.read_text())
            return Judgement(**{**data, "tests": tuple(data["tests"])})
        with tempfile.TemporaryDirectory() as name:
            notes = Path(name) / "notes"
            told = {"JUDGE_NOISE": str(noise), "JUDGE_NOTES": str(notes), "JUDGE_FIRST": first or ""}
            found = self._pytest(self._copied(Path(name), edits), told)
            found = replace(found, refused=notes.exists())
        if kept is not None:
            kept.parent.mkdir(parents=True, exist_ok=True)
            kept.write_text(json.dumps(asdict(found)))
        return found

    def _copied(self, place: Path, edits: Sequence[Edit]) -> Path:
        """A copy of the project with the edits in it, and beside it what they call."""
        copy = place / "beside" / self.folder.name
        shutil.copytree(self.folder, copy, ignore=IGNORED)
        (place / "planted").mkdir()
        (place / "tmp").mkdir()
        for file in PLANTED:
            shutil.copy(file, place / "planted" / f"_{file.name}")
        (place / "planted" / "_judge_seeds.py").write_text(SEEDS)
        for edit in sorted(edits, key=lambda edit: (edit.file, edit.start), reverse=True):
            file = copy / edit.file
            file.write_bytes(edit.applied(file.read_bytes()))
        return copy

    def _pytest(self, copy: Path, more: Mapping[str, str]) -> Judgement:
        facts = Facts.of(self.folder)
        settings = facts.settings
        place = copy.parent.parent
        environment = {
            "PATH": os.environ.get("PATH", ""),
            "HOME": os.environ.get("HOME", "/"),
            "LANG": "C.UTF-8",
            "COLUMNS": "400",
            "PYTHONPATH": str(place / "planted"),
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTHONHASHSEED": "0",
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
            "TMPDIR": str(place / "tmp"),
            "JUDGE_SEEDS": json.dumps(dict(self.seeds or {})),
            **more,
        }
        plugins = ["no:mutabot", "no:cacheprovider", "_judge_seeds", *facts.hints.get("plugins", [])]
        words = [
            *(sys.executable, "-m", "pytest", "-q", "-rfE", "--tb=short"),
            *(word for plugin in plugins for word in ("-p", plugin)),
            *(["-x"] if facts.hints.get("independent") else []),
            *settings.get("pytest_args", []),
            *settings.get("tests", []),
        ]
        with domain() if facts.hints.get("ros2") else nullcontext() as number:
            if number is not None:
                environment["ROS_DOMAIN_ID"] = str(number)
            return self._ended(words, copy, environment)

    def _ended(self, words: Sequence[str], copy: Path, environment: Mapping[str, str]) -> Judgement:
        began = time.monotonic()
        process = subprocess.Popen(
            words, cwd=copy, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True,
        )  # fmt: skip
        try:
            output, _ = process.communicate(timeout=self.limit)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            process.communicate()
            return Judgement("hangs")
        tests = dict.fromkeys(found[1] for line in output.splitlines() if (found := _SUMMARY.match(line)))
        state = "passes" if process.returncode == 0 else "fails"
        return Judgement(state, tuple(tests), text=output[-20000:], seconds=time.monotonic() - began)

    def _kept(self, given: tuple[Any, ...]) -> Path | None:
        if self.cache is None:
            return None
        digest = hashlib.sha256()
        files = [*self.folder.rglob("*"), *PLANTED, HERE / "judge.py"]
        for file in sorted(files):
            if file.is_file() and not {".mutabot", "__pycache__", ".pytest_cache"} & set(file.parts):
                digest.update(file.name.encode() + b"\0" + file.read_bytes() + b"\0")
        digest.update(repr(given).encode())
        return self.cache / f"{digest.hexdigest()}.json"


def is_drawn(mutant: Mapping[str, Any]) -> bool:
    """Whether a mutant rests on chance."""
    return mutant["operator"] in ("noise", "sensor-noise") or (
        "%" in mutant["variant"] and mutant.get("magnitude") is None
    )


def _is_of_reading(mutant: Mapping[str, Any]) -> bool:
    """Whether it changes what is read, which is never refused.

    What the program makes of it may be, and may stand in the same line.
    """
    return bool(mutant["operation"]) and ": reads " in mutant["description"]


def is_raced(mutant: Mapping[str, Any]) -> bool:
    """Whether it is a matter of time what a dying process still gets done."""
    return mutant["operator"] in ("kill-node", "restart-node")


def main() -> int:
    """Judge one mutant."""
    folder, file = sys.argv[1:]
    found = Judge(Path(folder).resolve()).mutant(json.loads(Path(file).read_text()), look_for_refusals=True)
    print(json.dumps(asdict(found), indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
