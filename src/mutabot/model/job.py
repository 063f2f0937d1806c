"""The job that the controller gives to the process that runs the robot program.

The controller writes one ``Job`` into the home of that process, which answers with the events of
``model.events``. It is pickled: every process below the tests reads one, and to make the same of JSON took a
tenth of the time that such a process takes. What comes back is never unpickled.
"""

from __future__ import annotations

import os
from _pickle import dumps, loads  # pickle has the same, and loads more than these need
from collections.abc import Mapping
from dataclasses import field, replace
from typing import Any

from mutabot.frozen import frozen
from mutabot.model.activation import TEXT_FAULT, Activation, Key
from mutabot.model.codec import from_data, is_plain, to_data
from mutabot.model.deadline import Limit
from mutabot.model.event_file import FOLDER
from mutabot.model.files import open_file, read_file
from mutabot.model.mutant import Mutant, Site, Span
from mutabot.model.operation import Vocabulary
from mutabot.model.program_text import Instrumentation

#: environment variable that names the job file; the plugin sleeps without it
JOB_VARIABLE = "MUTABOT_JOB"
#: environment variable with the number of the pipe's writing end
PIPE_VARIABLE = "MUTABOT_PIPE"


@frozen
class RefusedAt:
    """The calls at one site that the robot refuses in the original, in one test.

    Attributes:
        site, operation, pattern: the site, and what is called there.
        numbers: of these calls among all of the site in the test, from 1.
    """

    site: Site
    operation: str
    pattern: str | None
    numbers: tuple[int, ...]


@frozen
class Forking:
    """How a fork parent forks: which mutants, with how many processes, for how long.

    Attributes:
        mutants: the mutants that are alive in this round.
        tokens: where the pipe of the token pool can be opened; filled in by the process that runs the job.
        limits: the time that a fork may take for a test, by test.
        limit: the same for tests that are missing there.
        startup: the same until its first test begins.
        every_test: whether a fork goes on after a test that decided about its mutant.
        keys: where each mutant is forked, by its id: at the first of these keys that is reached.
        serial: whether the fork parent waits for each fork, since two of them would get in each other's way.
    """

    mutants: tuple[Mutant, ...]
    tokens: str = ""
    limits: Mapping[str, Limit] = field(default_factory=dict)
    limit: Limit = Limit(600.0)
    startup: Limit = Limit(600.0)
    every_test: bool = False
    serial: bool = False
    keys: Mapping[str, tuple[Key, ...]] = field(default_factory=dict)


@frozen
class Pictures:
    """The test that is filmed, and the file of its pictures.

    Attributes:
        test: its node id.
        file: absolute path of the film.
        writer: reference to what makes an ``evidence.recorder.PictureWriter`` of the path,
            ``module:attribute``.
    """

    test: str
    file: str
    writer: str


@frozen
class Job:
    """One run of tests as the original or as a mutant.

    Attributes:
        root: absolute path of the project; files in spans are relative to it.
        program, oracle: files and folders, relative to the root.
        vocabulary: the robot API.
        seed: the campaign's seed.
        round: 0-based round.
        tests: node ids to run, in this order; None for all that the project's own arguments select.
        aside: tests that the original has as well, but which judge nothing: others are the mutant's doing.
        reaching: by the ids of mutants, the numbers of the tests that reach them: after the first of these,
            all others are left out. Of mutants that are missing here, none is.
        mutant: the fault to plant; None for the original.
        record: whether to report traces and values.
        stop_at_kill: whether to stop after the first test that fails for another reason than a refusal.
        simulated: seconds of simulated time that each test may take, by node id; those that are missing may
            take any.
        spare: seconds of processor time within which no test has exceeded that.
        memory: address space limit in bytes; None for no limit.
        moments: after every how many commands the probes are read along the way, by node id; tests that are
            missing are read at their end only.
        inspect: whether to check every callable of the vocabulary at the end, also those that no test
            imported.
        forking: set for a fork parent: fork once for each live mutant at its site.
        serving: set for a fork server: the socket over which jobs come. It runs no test itself.
        instrumentation: what to put into the program text; None to leave it alone.
        private_files: whether the process is to keep to itself what it does to files.
        oracle_nodes: resolved names of the tests' own nodes, in which ``*`` stands for any text.
        refused: the calls that the robot refuses in the original, by node id: a mutant that is refused there
            as well is judged by its tests.
        known: sites at which all of an operation's name is one, whatever it is: elsewhere in the suite it is.
        evidence: whether to record what the world does while tests run.
        pictures: which test is filmed; None for none.
        extensions: references to what packages bring, by kind and name, see ``extensions.use``.
        active: how the mutant, or those to be forked, become active, by their ids.
        guards: what stands before every operation: the reference of each ``CallGuard``, and its table.
        key: of the seals on its events, see ``event_file``.
    """

    root: str
    program: tuple[str, ...]
    oracle: tuple[str, ...]
    vocabulary: Vocabulary
    seed: int
    round: int
    tests: tuple[str, ...] | None = None
    aside: tuple[str, ...] = ()
    reaching: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    mutant: Mutant | None = None
    record: bool = False
    stop_at_kill: bool = False
    simulated: Mapping[str, float] = field(default_factory=dict)
    spare: float = 0.0
    memory: int | None = None
    moments: Mapping[str, int] = field(default_factory=dict)
    inspect: bool = False
    forking: Forking | None = None
    serving: int | None = None
    instrumentation: Instrumentation | None = None
    private_files: bool = True
    oracle_nodes: tuple[str, ...] = ()
    refused: Mapping[str, tuple[RefusedAt, ...]] = field(default_factory=dict)
    known: tuple[tuple[Span, str], ...] = ()
    evidence: bool = False
    pictures: Pictures | None = None
    extensions: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    active: Mapping[str, Activation] = field(default_factory=dict)
    guards: tuple[tuple[str, Mapping[str, Any]], ...] = ()
    key: str = ""

    @property
    def is_of_text(self) -> bool:
        """Whether the job concerns the program text alone, without calls, a clock or other faults."""
        is_of_text = all(activation.reference == TEXT_FAULT for activation in self.active.values())
        return is_of_text and not (self.vocabulary.operations or self.vocabulary.clock)

    @property
    def is_of_original(self) -> bool:
        """Whether it runs the original and forks no mutants: what tests read as text is looked at."""
        return self.mutant is None and self.forking is None

    def below(self, mutant: Mutant, activation: Activation) -> Job:
        """Return the job of the processes below a fork that is this mutant."""
        text = self.instrumentation.only(activation.places) if self.instrumentation is not None else None
        slim = replace(
            self, mutant=mutant, active={mutant.id: activation}, forking=None, instrumentation=text,
            reaching={}, tests=None,
        )  # fmt: skip
        return replace(slim, simulated={}, extensions={}) if self.is_of_text else slim

    def filmed(self, test: str, file: str, writer: str) -> Job:
        """Return the same job with one test that is recorded and filmed; see ``Pictures``."""
        # libraries of graphics reserve far more addresses than they use
        pictures = Pictures(test, file, writer)
        return replace(self, stop_at_kill=False, evidence=True, pictures=pictures, memory=None)

    def left_out(self, mutant: str) -> frozenset[str]:
        """Return the tests that are left out for this mutant once it has been reached."""
        numbers = self.reaching.get(mutant)
        if not numbers or self.tests is None:
            return frozenset()
        return frozenset(self.tests[min(numbers) :]).difference(self.tests[number] for number in numbers)


#: in the folder of a fork parent's worker: as soon as it is there, forks are wanted no more
STOP = "stop"


def job_file(home: str | os.PathLike[str]) -> str:
    """Return the path of the job of the worker with this folder.

    It is where processes below the worker look for it: a fork has that folder to itself.
    """
    return os.path.join(home, FOLDER, "job")


def write_job(home: str | os.PathLike[str], job: Job) -> None:
    """Write a worker's job into its folder."""
    with os.fdopen(open_file(job_file(home), os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644), "wb") as file:
        file.write(dumps(job))


def read_job(home: str | os.PathLike[str]) -> Job:
    """Return the job of the worker with this folder."""
    job: Job = loads(read_file(job_file(home)))
    return job


@frozen
class Idle:
    """The answers of a command at one place in the baseline, by test.

    Attributes:
        answers: the different answers, as data that ``answer.restore`` understands.
        of_test: number of the answer that was the first in a test, by ``key``; tests that are missing here
            get the first of all.
        varying: keys of the tests in which later answers were others: there the answer carries information
            about the world, which stands still while the robot does nothing.
    """

    answers: tuple[Any, ...]
    of_test: Mapping[str, int] = field(default_factory=dict)
    varying: tuple[str, ...] = ()

    @staticmethod
    def key(round: int, test: str) -> str:
        """Return a test in a round, 0-based."""
        return f"{round} {test}"

    @classmethod
    def of(cls, data: Any) -> Idle:
        """Return the answers in a mutant's ``idle``; a plain value there is the only answer."""
        return cls((data,)) if is_plain(data) else from_data(cls, data)

    def data(self) -> Any:
        """Return the answers as data that a mutant carries."""
        single = len(self.answers) == 1 and not self.varying and is_plain(self.answers[0])
        return self.answers[0] if single else to_data(self)

    def in_round(self, round: int) -> Any:
        """Return the answers that count in a round."""
        here = {key: number for key, number in self.of_test.items() if key.startswith(f"{round} ")}
        used = sorted({0, *here.values()})
        return [
            [self.answers[number] for number in used],
            {key: used.index(number) for key, number in here.items()},
            [key for key in self.varying if key in here],
        ]

    def first(self, round: int, test: str) -> Any:
        """Return the data of the first answer in a test."""
        return self.answers[self.of_test.get(self.key(round, test), 0)]

    def is_varying(self, round: int, test: str) -> bool:
        """Return whether answers differed within a test; for an unknown test, within any test."""
        key = self.key(round, test)
        return key in self.varying if key in self.of_test else bool(self.varying)
