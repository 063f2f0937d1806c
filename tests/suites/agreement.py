"""Every mutant of a project by both engines and by the third judge, and where they disagree."""

from __future__ import annotations

import random
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

from mutabot.analysis.results import read_results
from mutabot.campaign.request import Request
from mutabot.campaign.run import plan_only, run_campaign
from mutabot.errors import MutabotError
from mutabot.inside.seeds import derive
from mutabot.journal.journal import Journal
from mutabot.report.as_json import mutant_data, results_data
from mutabot.settings.configuration import load_configuration
from mutabot.vocabulary import load

from .editor import Facts
from .judge import IGNORED, MORE_DRAWS, Judge, Judgement

ENGINES = ("branch", "replay")
PROJECTS = Path(__file__).resolve().parent / "projects"
#: no verdict: the plan says that the mutant would change nothing
LEFT_OUT = "left out"
#: what plain pytest must say for a verdict; what is no command ends the test that sends it
EXPECTED = {
    "killed": ("fails", "hangs"),
    "timeout": ("fails", "hangs"),
    "invalid": ("fails",),
    "survived": ("passes",),
    "no effect": ("passes",),
    "not covered": ("passes",),
    LEFT_OUT: ("passes",),
}


class Silent:
    """A progress that says nothing."""

    def stage(self, text: str, total: int | None = None) -> None:
        """Ignore it."""

    def advance(self, line: str | None = None) -> None:
        """Ignore it."""

    def note(self, text: str) -> None:
        """Ignore it."""


@dataclass(frozen=True)
class Verdict:
    """What one engine says about one mutant, and what plain pytest says."""

    project: str
    engine: str
    mutant: str
    number: int
    description: str
    ours: str
    test: str | None
    message: str
    plain: Judgement

    @property
    def compared(self) -> bool:
        """Whether the two can be held against each other."""
        return self.plain.state != "unwritable"

    @property
    def agrees(self) -> bool:
        """Whether they say the same about the suite."""
        if self.ours == "refused" or self.plain.refused:
            return self.ours == "refused" and self.plain.refused
        return self.plain.state in EXPECTED.get(self.ours, ())

    @property
    def names_another_test(self) -> bool:
        """Whether a kill names a test that passes in plain pytest.

        What fails in the tear-down of a shared fixture is said of the last test that ran, maybe another.
        """
        if self.ours != "killed" or not self.plain.tests:
            return False
        # where a file cannot be imported, or a class fails as a whole, pytest names that
        return not any(
            self.test == one or (self.test or "").startswith(f"{one}::") or one.startswith(f"{self.test}::")
            for one in self.plain.tests
        )

    @property
    def line(self) -> str:
        """The disagreement in one line."""
        tests = ", ".join(self.plain.tests[:3])
        plain = f"{self.plain.state} ({tests})" if tests else self.plain.state
        return (
            f"{self.project} [{self.engine}] #{self.number} {self.mutant}: {self.description}\n"
            f"    ours: {self.ours} by {self.test}: {self.message[:110]!r}; plain pytest: {plain}"
        )


@dataclass
class Found:
    """What came of one project.

    Attributes:
        verdicts: all of both engines.
        failed: campaigns that ended in an error, or a project that fails as it is.
    """

    project: str
    verdicts: list[Verdict] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)

    @property
    def compared(self) -> list[Verdict]:
        """Verdicts that were held against plain pytest."""
        return [one for one in self.verdicts if one.compared]

    @property
    def disagreements(self) -> list[str]:
        """Everything that is not as it must be, one text each."""
        return [*self.failed, *(one.line for one in self.compared if not one.agrees)]


def compare(
    folder: Path,
    *,
    families: Sequence[str] = ("robot",),
    only: Mapping[str, int] | None = None,
    engines: Sequence[str] = ENGINES,
    jobs: int = 2,
    cache: Path | None = None,
    limit: float = 30.0,
) -> Found:
    """Run a copy of the project by each engine, and hold every verdict against plain pytest.

    Args:
        folder: the project; it is never written to.
        families: families of mutants.
        only: how many mutants of a family to draw by a fixed seed; all of the others.
        engines: which engines.
        jobs: processes at a time.
        cache: folder that keeps what plain pytest said, or None.
        limit: seconds after which a plain run counts as hanging.
    """
    found = Found(folder.name)
    results: dict[str, dict[str, Any]] = {}
    with tempfile.TemporaryDirectory() as name:
        selection = None
        for engine in engines:
            copy = Path(name).resolve() / engine / folder.name
            shutil.copytree(folder, copy, ignore=IGNORED)
            try:
                wanted = request_for(copy, engine, families, jobs, Facts.of(folder).hints.get("plugins", ()))
                if only and selection is None:
                    selection = Path(name) / "selection.txt"
                    selection.write_text("\n".join(chosen(wanted, only)) + "\n", encoding="utf-8")
                results[engine] = campaign(replace(wanted, selection=selection))
            except MutabotError as error:
                found.failed.append(f"{folder.name} [{engine}] the campaign stops: {str(error)[:600]}")
    if "robot" not in (only or {}):
        for data in results.values():
            data["mutants"] += list(left_out(data))
    mutants = {one["id"]: one for data in results.values() for one in data["mutants"]}
    judge = Judge(folder, limit, seeds_of(results), cache)
    original = judge.original()
    if original.state != "passes":
        found.failed.append(f"{folder.name}: plain pytest {original.state} on the original\n{original.text}")
        return found
    refusals = Facts.of(folder).refusals
    refused = {
        one.id for data in results.values() for one in _ended(data) if one.is_or_could_be_refused(refusals)
    }

    def judged(mutant: Mapping[str, Any]) -> Judgement:
        return judge.mutant(mutant, look_for_refusals=mutant["id"] in refused)

    with ThreadPoolExecutor(jobs) as pool:
        plain = dict(zip(mutants, pool.map(judged, mutants.values()), strict=True))
    for one in (end for data in results.values() for end in _ended(data)):
        # what few draws of noise say may be chance
        explained = ("unwritable", *EXPECTED.get(one.verdict, ()))
        if mutants[one.id]["operator"] == "noise" and plain[one.id].state not in explained:
            plain[one.id] = judge.mutant(mutants[one.id], draws=MORE_DRAWS)
    for engine, data in results.items():
        found.verdicts += [
            verdict(folder.name, engine, mutants[one.id], one, plain[one.id]) for one in _ended(data)
        ]
    return found


def left_out(data: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Mutants of calls that the plan leaves out because they would change nothing, where they stand.

    The place is that of another mutant of the same call. Without one, and in text commands, it is not known.
    """
    places = {one["id"].rpartition(":")[0].rpartition(":")[0]: one for one in data["mutants"]}
    for item in data["left_out"]:
        subject, _, operator = item["id"].rpartition(":")
        site, _, quantity = subject.rpartition(":")
        other = places.get(site)
        if (
            other
            and other["operation"]
            and not other["pattern"]
            and item["reason"].startswith("would change nothing")
        ):
            name, _, variant = operator.partition("=")
            changed = {
                "operator": name,
                "variant": variant,
                "quantity": None if quantity == "call" else quantity,
            }
            yield {
                **other,
                "id": item["id"],
                "description": item["description"],
                "rounds": [{"verdict": LEFT_OUT}],
                **changed,
            }


def verdict(project: str, engine: str, mutant: Mapping[str, Any], end: _End, plain: Judgement) -> Verdict:
    """What an engine and plain pytest say about a mutant."""
    return Verdict(
        project,
        engine,
        end.id,
        mutant["number"],
        mutant["description"],
        end.verdict,
        end.test,
        end.message,
        plain,
    )


@dataclass(frozen=True)
class _End:
    id: str
    verdict: str
    test: str | None
    exception: str
    message: str

    def is_or_could_be_refused(self, refusals: Sequence[str]) -> bool:
        """Whether a refusal, or a group that may hold one, ended a test."""
        could_be = self.exception in refusals or self.exception.endswith("ExceptionGroup")
        return self.verdict == "refused" or (self.verdict == "killed" and could_be)


def _ended(data: Mapping[str, Any]) -> Iterator[_End]:
    for mutant in data["mutants"]:
        first = mutant["rounds"][0]
        yield _End(
            mutant["id"],
            str(first["verdict"]),
            first.get("test"),
            first.get("exception") or "",
            first.get("message") or "",
        )


def request_for(
    folder: Path, engine: str, families: Sequence[str], jobs: int, needed: Sequence[str] = ()
) -> Request:
    """The request of a campaign of one round, without pytest plug-ins that the project does not need."""
    configuration = load_configuration(folder)
    off = [f"no:{entry.name}" for entry in entry_points(group="pytest11")
           if entry.name not in ("mutabot", *needed)]  # fmt: skip
    more = [word for name in off for word in ("-p", name)]
    configuration = configuration.model_copy(update={"pytest_args": (*configuration.pytest_args, *more)})
    return Request(
        configuration, load(configuration.vocabulary, configuration.root), 1, configuration.seed, jobs,
        fresh=True, families=tuple(families), engine="auto" if engine == "branch" else engine,
    )  # fmt: skip


def campaign(request: Request) -> dict[str, Any]:
    """A whole campaign, as the JSON of ``mutabot results``."""
    with Journal.open(run_campaign(request, Silent())) as journal:
        return results_data(read_results(journal))


def chosen(request: Request, only: Mapping[str, int]) -> list[str]:
    """Ids of the mutants to run, drawn by a fixed seed."""
    by_family: dict[str, list[str]] = {}
    for mutant in map(mutant_data, plan_only(request, Silent())[0]):
        by_family.setdefault(mutant["family"], []).append(mutant["id"])
    draw = random.Random(1)
    return [
        one
        for family, ids in by_family.items()
        for one in sorted(draw.sample(ids, min(only.get(family, len(ids)), len(ids))))
    ]


def seeds_of(results: Mapping[str, Mapping[str, Any]]) -> dict[str, int]:
    """What the fixture ``mutabot_seed`` gives in the first round, by test."""
    return {
        one["test"]: derive(data["meta"]["seed"], 0, one["test"])
        for data in results.values()
        for one in data["baseline"]
    }


def corpus() -> list[Path]:
    """All projects of the corpus."""
    return sorted(path.parent for path in PROJECTS.glob("*/mutabot.toml"))
