"""The request for a campaign, and the interface by which it reports its progress."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, Self

from mutabot.campaign.project_files import ProjectListing
from mutabot.config.configuration import Configuration
from mutabot.config.options import ALL, AUTO, ENGINES, FORK, Sample, Shard
from mutabot.errors import UsageError, unknown_name_text
from mutabot.extensions import brought, references_for_processes
from mutabot.families import USUAL
from mutabot.faults import Project
from mutabot.frozen import frozen
from mutabot.journal.files import HOME, JOURNAL
from mutabot.languages.registry import languages_of
from mutabot.model import Moment, Probe, Vocabulary
from mutabot.model.job import Job

if TYPE_CHECKING:
    from mutabot.config.table import Table
    from mutabot.execution.task import Executor
    from mutabot.execution.workers import Workers
    from mutabot.model.mutant_end import MutantEnd

#: outcomes over a simulation that are run again over the real middleware, unless ``--verify`` says otherwise
VERIFIED = 5


class Preview(Protocol):
    """What an executor will copy to other machines, known in advance.

    Attributes:
        folders_left_out: folders with files that stay here, relative to the project: which of these files
            tests open is watched while the baseline is taken.
    """

    @property
    def folders_left_out(self) -> Collection[str]: ...

    def lacking(self, opened: Collection[str] | None) -> str | None:
        """Describe the files that tests opened here and will lack there; None if they lack none."""

    def check(self, opened: Collection[str] | None) -> tuple[list[str], Mapping[str, Any]]:
        """Return what ``mutabot check`` reports of it: lines for people, and the same data for machines."""


class ExecutorChoice(ABC):
    """An executor as the command line names it, with its settings. The base class for those of packages."""

    @classmethod
    @abstractmethod
    def parse(cls, value: str, root: Path, table: Table | None) -> Self:
        """Parse the value of the executor's option.

        Args:
            value: what stands after the option, such as ``tcp://scheduler:8786``.
            root: the project's folder.
            table: the table of the executor's name in the configuration; None if there is none.

        Raises UsageError for a value that cannot be meant.
        """

    @classmethod
    def implied(cls, table: Table) -> Self | None:
        """Return the choice that a configuration with this table means if the command line names none.

        None if tasks then run on this machine.
        """
        return None

    def fitted(self, request: Request) -> Request:
        """Return the request as it can be carried out here. Raises UsageError if it cannot."""
        return request

    @abstractmethod
    def open(self, request: Request, notify: Callable[[str], None]) -> AbstractContextManager[Executor]:
        """Open the executor. Raises UsageError if it is not available.

        ``notify``: called with messages for the user about where and how tasks run.
        """

    @classmethod
    def preview(cls, request: Request) -> Preview | None:
        """Return what the executor would copy elsewhere; None if all stays on this machine.

        ``mutabot check`` asks this where the configuration has a table of the executor's name.
        """
        return None


@dataclass(frozen=True)
class Request:
    """The request for one campaign.

    Attributes:
        configuration: the project's configuration.
        vocabulary: the robot API.
        rounds, seed, jobs: as in the configuration, unless the command line says otherwise.
        only, skip: selections as in ``select``.
        operators: which operators' mutants are selected: ``all``, or ``common`` for those that are so.
        engine: name of the engine; ``auto`` for the first that can judge a mutant.
        executor: what runs the tasks; None for worker processes on this machine.
        fresh: whether to run everything, also what an earlier campaign has found.
        verify: how many outcomes to run once more in fresh processes, over the real middleware, and compare;
            None for some if there is a simulation, else for none.
        repeats: whether to run once more the kills that may be chance.
        baseline: how often the baseline runs each round; None for as often as the engine needs.
        families: the families of operators whose mutants are made.
        every_test: whether a mutant runs every test that reaches it, also after one has noticed it.
        sample: how many of the mutants to run, chosen at random; None for all.
        journal: name of the journal's file in mutabot's folder.
        moments: at which of their calls mutants act, a mutant each; None for every call.
        shard: the part of the plan to run; None for all of it.
        evidence: whether to record what the world does while tests run.
        since: the revision of git from which on changes are looked at; None for no such comparison.
        other_journal: a journal, or the folder of a project, to take outcomes over from beside the own one.
        budget: seconds that the campaign may take; None for no limit.
        simulation: name of the simulation over which the tests run; empty for none.
        ran_over: why they run over it, or do not, in a sentence; empty if there is nothing to choose.
    """

    configuration: Configuration
    vocabulary: Vocabulary
    rounds: int
    seed: int
    jobs: int
    only: tuple[str, ...] = ()
    skip: tuple[str, ...] = ()
    operators: str = ALL
    engine: str = AUTO
    executor: ExecutorChoice | None = None
    fresh: bool = False
    verify: int | None = None
    repeats: bool = True
    baseline: int | None = None
    families: tuple[str, ...] = USUAL
    every_test: bool = False
    sample: Sample | None = None
    journal: str = JOURNAL
    moments: tuple[Moment | None, ...] = (None,)
    shard: Shard | None = None
    evidence: bool = False
    since: str | None = None
    other_journal: Path | None = None
    budget: float | None = None
    simulation: str = ""
    ran_over: str = ""

    @property
    def engines(self) -> tuple[str, ...]:
        """The engines that it may use, in the order in which they are tried. Raises UsageError if none."""
        found = tuple(name for name in ENGINES if self.engine in (AUTO, name))
        if not found:
            raise UsageError(unknown_name_text("engine", self.engine, (AUTO, *ENGINES)))
        return found

    @property
    def forks(self) -> bool:
        """Whether mutants are forked where possible."""
        return FORK in self.engines

    @property
    def repetitions(self) -> int:
        """How often the baseline runs each round; with forks, their parent is a further run."""
        return max(1 if self.forks else 2, self.baseline or 0)

    @property
    def root(self) -> Path:
        """The project's folder."""
        return self.configuration.root

    @property
    def project(self) -> Project:
        """The project as providers of faults see it; demands on magnitudes concern single faults."""
        return Project(
            self.root,
            self.configuration.program,
            self.vocabulary,
            self.families,
            self.moments,
            self.configuration.demands,
            self.configuration.tables,
        )

    @property
    def arguments(self) -> tuple[str, ...]:
        """The project's pytest arguments."""
        return (*self.configuration.tests, *self.configuration.pytest_args)

    @property
    def journal_path(self) -> Path:
        """The path of the project's journal."""
        return self.root / HOME / self.journal

    def files(self) -> ProjectListing:
        """Return the project's files, for executors that copy some elsewhere. Raises UsageError."""
        return ProjectListing.of(self.root, self.configuration)

    def on_this_machine(self, notify: Callable[[str], None]) -> AbstractContextManager[Workers]:
        """Open an executor on this machine that runs ``jobs`` tasks at a time; leaving it ends all.

        ``notify``: called with messages for the user about how tasks run.

        Raises JournalError where mutabot's folder in the project cannot be written to.
        """
        from mutabot.execution.workers import Workers  # noqa: PLC0415  # a request alone needs none

        return Workers(self.root, self.arguments, self.jobs, notify)

    def changed(
        self,
        *,
        root: Path | None = None,
        tests: tuple[str, ...] | None = None,
        probes: Mapping[str, float] | None = None,
    ) -> Self:
        """Return the same request for a changed project.

        Args:
            root: the folder of a copy of the project; None for the project itself.
            tests: the tests to run, as arguments of pytest; None for those of the configuration.
            probes: further probes, ``module:qualified.name``, each with its tolerance.
        """
        changes = {"root": root, "tests": tests}
        configuration = self.configuration.model_copy(
            update={name: value for name, value in changes.items() if value is not None}
        )
        added = (Probe(target, tolerance) for target, tolerance in (probes or {}).items())
        vocabulary = replace(self.vocabulary, probes=(*self.vocabulary.probes, *added))
        return replace(self, configuration=configuration, vocabulary=vocabulary)

    def clock(self) -> float:
        """Return the seconds since an arbitrary moment, by the clock of the campaign's budget."""
        return time.monotonic()

    @property
    def guards(self) -> tuple[tuple[str, Mapping[str, Any]], ...]:
        """The guards that check every operation: a reference to each, and its table."""
        tables = self.configuration.tables
        return tuple(
            (part.reference, tables[name].model_dump(mode="json"))
            for name, part in (brought("guards") if tables else {}).items()
            if name in tables
        )

    def job(self, round: int, **details: Any) -> Job:
        """Return a job of this campaign in a round."""
        return Job(
            root=str(self.root),
            program=self.configuration.program,
            oracle=self.configuration.oracle,
            vocabulary=self.vocabulary,
            seed=self.seed,
            round=round,
            memory=self.configuration.memory,
            private_files=self.configuration.private_files,
            oracle_nodes=self.configuration.oracle_nodes,
            evidence=self.evidence,
            extensions=references_for_processes(languages_of(self.root, self.configuration.program)),
            guards=self.guards,
            **details,
        )


class Progress(Protocol):
    """Shows what a campaign is doing. The methods of this base class do nothing."""

    @property
    def left(self) -> float | None:
        """The estimated time (s) that the rest of the stage takes; None if too little is known yet."""
        return None

    def stage(self, text: str, total: int | None = None) -> None:
        """Begin a new stage, with its number of steps if that is known."""
        return

    def mutant_ended(self, end: MutantEnd) -> None:
        """Report that a mutant has ended in a round, now or earlier; this is no step of a stage."""
        return

    def advance(self, line: str | None = None) -> None:
        """Report that a step is done; ``line`` says which."""
        return

    def note(self, text: str) -> None:
        """Show a message to the user."""
        return


@frozen
class CheckReport:
    """The result of ``mutabot check``.

    Attributes:
        lines: for people.
        data: the same for machines.
    """

    lines: list[str]
    data: Mapping[str, Any]
