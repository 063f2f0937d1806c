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

from mutabot.campaign.checking import plan_only
from mutabot.campaign.request import Progress, Request
from mutabot.campaign.run import run_campaign
from mutabot.config.configuration import load_configuration
from mutabot.config.vocabulary import load_vocabulary
from mutabot.errors import MutabotError
from mutabot.journal.journal import Journal
from mutabot.report.document import data_of, document
from mutabot.results.results import read_results
from mutabot.runtime.seeds import derive

from .corpus import copied
from .editor import Facts
from .graded_editor import OPERATORS as GRADED_OPERATORS
from .judge import IGNORED, MORE_DRAWS, Judge, Judgement, is_drawn, is_raced
from .message_editor import is_named

ENGINES = ("fork", "replay")
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


class Silent(Progress):
    """A progress that shows nothing."""


@dataclass(frozen=True)
class Verdict:
    """What one engine says about one mutant in one round, and what plain pytest says."""

    project: str
    engine: str
    mutant: str
    number: int
    description: str
    ours: str
    test: str | None
    message: str
    plain: Judgement
    round: int = 1

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
            self.test == test
            or (self.test or "").startswith(f"{test}::")
            or test.startswith(f"{self.test}::")
            for test in self.plain.tests
        )

    @property
    def line(self) -> str:
        """The disagreement in one line."""
        tests = ", ".join(self.plain.tests[:3])
        plain = f"{self.plain.state} ({tests})" if tests else self.plain.state
        return (
            f"{self.project} [{self.engine}, round {self.round}] #{self.number} {self.mutant}: "
            f"{self.description}\n"
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
        return [judged for judged in self.verdicts if judged.compared]

    @property
    def disagreements(self) -> list[str]:
        """Everything that is not as it must be, one text each."""
        return [
            *self.failed,
            *self.differing,
            *(judged.line for judged in self.compared if not judged.agrees),
        ]

    @property
    def differing(self) -> list[str]:
        """Mutants of which two campaigns say different things in the same round."""
        ends: dict[tuple[str, int], dict[str, str]] = {}
        for judged in self.verdicts:
            ends.setdefault((judged.mutant, judged.round), {})[judged.engine] = judged.ours
        return [
            f"{self.project} [round {which}] {mutant}: {said}"
            for (mutant, which), said in ends.items()
            if len(set(said.values())) > 1
        ]


def compare(
    folder: Path,
    *,
    families: Sequence[str] = ("robot",),
    only: Mapping[str, int] | None = None,
    engines: Sequence[str] = ENGINES,
    jobs: int = 2,
    cache: Path | None = None,
    limit: float = 30.0,
    rounds: int = 1,
) -> Found:
    """Run a copy of the project by each engine, and hold every verdict against plain pytest.

    Args:
        folder: the project; it is never written to.
        families: families of mutants.
        only: how many mutants of a family to draw by a fixed seed; all of the others.
        engines: which engines.
        jobs: processes at a time.
        cache: folder that keeps what plain pytest said, or None.
        limit: seconds after which a plain run counts as hanging, or three times what the original takes, if
            that is more; the original may take ten times as long.
        rounds: rounds of the campaign; each is held against plain pytest with its own seeds.
    """
    with tempfile.TemporaryDirectory() as name:
        whole = copied(folder, Path(name).resolve() / "whole" / folder.name)
        return _compare(whole, families, only or {}, engines, jobs, cache, limit, rounds)


def _compare(
    folder: Path,
    families: Sequence[str],
    only: Mapping[str, int],
    engines: Sequence[str],
    jobs: int,
    cache: Path | None,
    limit: float,
    rounds: int,
) -> Found:
    found = Found(folder.name)
    results: dict[str, dict[str, Any]] = {}
    with tempfile.TemporaryDirectory() as name:
        selection = None
        for engine in engines:
            copy = Path(name).resolve() / engine / folder.name
            shutil.copytree(folder, copy, ignore=IGNORED)
            try:
                plugins = Facts.of(folder).hints.get("plugins", ())
                wanted = request_for(copy, engine, families, jobs, plugins, rounds)
                if only and selection is None:
                    selection = Path(name) / "selection.txt"
                    selection.write_text("\n".join(chosen(wanted, only)) + "\n", encoding="utf-8")
                results[engine] = campaign(replace(wanted, only=(f"@{selection}",)) if selection else wanted)
            except MutabotError as error:
                found.failed.append(f"{folder.name} [{engine}] the campaign stops: {str(error)[:600]}")
    if "robot" not in only:
        for data in results.values():
            data["mutants"] += list(left_out(data))
    mutants = {mutant["id"]: mutant for data in results.values() for mutant in data["mutants"]}
    refusals = Facts.of(folder).refusals
    for which in range(1, rounds + 1):
        ends = [(engine, ended) for engine, data in results.items() for ended in _ended(data, which)]
        judge = Judge(folder, limit, seeds_of(results, which), cache)
        original = replace(judge, limit=10 * limit).original()
        if original.state != "passes":
            found.failed.append(
                f"{folder.name}: plain pytest {original.state} on the original\n{original.text}"
            )
            return found
        judge = replace(judge, limit=max(limit, 3 * original.seconds))
        refused = {judged.id for _, judged in ends if judged.is_or_could_be_refused(refusals)}
        noticed = {judged.id: judged.test for _, judged in ends}
        plain = _judged(judge, mutants, refused, noticed, jobs)
        for _, finished in ends:
            # what few draws say may be chance
            explained = ("unwritable", *EXPECTED.get(finished.verdict, ()))
            rests_on_chance = is_drawn(mutants[finished.id]) or is_raced(mutants[finished.id])
            if rests_on_chance and plain[finished.id].state not in explained:
                plain[finished.id] = judge.mutant(mutants[finished.id], draws=MORE_DRAWS, first=finished.test)
        found.verdicts += [
            verdict(folder.name, engine, mutants[judged.id], judged, plain[judged.id], which)
            for engine, judged in ends
        ]
    return found


def _judged(
    judge: Judge,
    mutants: Mapping[str, Mapping[str, Any]],
    refused: set[str],
    noticed: Mapping[str, str | None],
    jobs: int,
) -> dict[str, Judgement]:
    """What plain pytest says of each mutant.

    ``refused`` are those of which an engine speaks of refusals, ``noticed`` tells which tests noticed them.
    """

    def judged(mutant: Mapping[str, Any]) -> Judgement:
        id = mutant["id"]
        return judge.mutant(mutant, look_for_refusals=id in refused, first=noticed.get(id))

    with ThreadPoolExecutor(jobs) as pool:
        return dict(zip(mutants, pool.map(judged, mutants.values()), strict=True))


def left_out(data: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Mutants of calls that the plan leaves out because they would change nothing, where they stand.

    The place is that of another mutant of the same call. Without one, and in text commands, it is not known.
    One call of the program may set up a publisher and publish: its description says which of them is meant.
    """
    places = {mutant["id"].rpartition(":")[0].rpartition(":")[0]: mutant for mutant in data["mutants"]}
    for item in data["left_out"]:
        subject, _, operator = item["id"].rpartition(":")
        if operator.partition("=")[0] in GRADED_OPERATORS:
            continue  # its magnitude is not told
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
            if is_named(other):
                changed["operation"] = item["description"].partition(": ")[0]
            yield {
                **other,
                "id": item["id"],
                "description": item["description"],
                "rounds": [{"verdict": LEFT_OUT}],
                **changed,
            }


def verdict(
    project: str, engine: str, mutant: Mapping[str, Any], end: _End, plain: Judgement, which: int
) -> Verdict:
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
        which,
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


def _ended(data: Mapping[str, Any], which: int) -> Iterator[_End]:
    for mutant in data["mutants"]:
        # what the plan leaves out, it leaves out of all rounds
        end = mutant["rounds"][min(which, len(mutant["rounds"])) - 1]
        yield _End(
            mutant["id"],
            str(end["verdict"]),
            end.get("test"),
            end.get("exception") or "",
            end.get("message") or "",
        )


def request_for(
    folder: Path, engine: str, families: Sequence[str], jobs: int, needed: Sequence[str] = (), rounds: int = 1
) -> Request:
    """The request of a campaign, without pytest plug-ins that the project does not need."""
    configuration = load_configuration(folder)
    off = [f"no:{entry.name}" for entry in entry_points(group="pytest11")
           if entry.name not in ("mutabot", *needed)]  # fmt: skip
    more = [word for name in off for word in ("-p", name)]
    configuration = configuration.model_copy(update={"pytest_args": (*configuration.pytest_args, *more)})
    vocabulary = load_vocabulary(configuration.vocabulary, configuration.root)
    return Request(
        configuration, vocabulary, rounds, configuration.seed, jobs,
        fresh=True, families=tuple(families), engine="auto" if engine == "fork" else engine, evidence=True,
    )  # fmt: skip


def campaign(request: Request) -> dict[str, Any]:
    """A whole campaign, as the JSON of ``mutabot results``."""
    with Journal.open(run_campaign(request, Silent())) as journal:
        data = document(read_results(journal))
    # of a ladder the search runs some magnitudes; reports hold them apart, the judge does not
    ran = [mutant for mutant in data["graded"] if all(end.get("verdict") for end in mutant["rounds"])]
    return {**data, "mutants": [*data["mutants"], *ran]}


def chosen(request: Request, only: Mapping[str, int]) -> list[str]:
    """Ids of the mutants to run, drawn by a fixed seed."""
    by_family: dict[str, list[str]] = {}
    for mutant in map(data_of, plan_only(request, Silent()).mutants):
        by_family.setdefault(mutant["family"], []).append(mutant["id"])
    draw = random.Random(1)
    return [
        chosen_id
        for family, ids in by_family.items()
        for chosen_id in sorted(draw.sample(ids, min(only.get(family, len(ids)), len(ids))))
    ]


def seeds_of(results: Mapping[str, Mapping[str, Any]], which: int = 1) -> dict[str, int]:
    """What the fixture ``mutabot_seed`` gives in a round, counted from 1, by test."""
    return {
        baseline_test["test"]: derive(data["meta"]["seed"], which - 1, baseline_test["test"])
        for data in results.values()
        for baseline_test in data["baseline"]
    }
