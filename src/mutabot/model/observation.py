"""The job of an observed run, and the files to which its processes write their observations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mutabot.frozen import frozen

#: environment variable that names the run's folder; the plug-in sleeps without it
VARIABLE = "MUTABOT_OBSERVATION"
#: in that folder: the job; how the file of each process ends, and the name of that of the tests' process
JOB, SEEN, TESTS = "observation.json", ".seen.json", "tests"


@frozen
class ObservationJob:
    """An observed run, without any mutant.

    Attributes:
        root: absolute path of the project.
        program, tests: files of either side, relative to the root.
        observer: ``module:Name`` of a ``runtime.observer.Observer``.
        extensions: references to what packages bring, by kind and name, see ``extensions.use``.
        libraries: client libraries of middlewares, with ``*`` for any text.
    """

    root: str
    program: Sequence[str]
    tests: Sequence[str]
    observer: str
    extensions: Mapping[str, Mapping[str, str]]
    libraries: Sequence[str]
