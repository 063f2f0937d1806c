"""The configuration: ``[tool.mutabot]`` in ``pyproject.toml``, or ``mutabot.toml``."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import partial
from itertools import product
from pathlib import Path, PurePosixPath
from typing import Annotated, Any

import pydantic
from pydantic import AfterValidator, BeforeValidator, Field
from pydantic_core import CoreSchema

from mutabot.config import options
from mutabot.errors import ConfigurationError, nearest_name, shortened
from mutabot.extensions import brought, not_installed
from mutabot.families import USUAL
from mutabot.faults import families_brought, known_families, need_vocabulary, why_unknown
from mutabot.model import Moment
from mutabot.model.mutant import EVERY
from mutabot.testpaths import test_paths
from mutabot.thresholds.demands import Demand

from .demands import check_demands
from .document import Document
from .mistakes import DocumentPlace, raise_errors
from .options import overridden
from .table import Table

_NO_VOCABULARY = (
    "the key 'vocabulary' is missing or empty; mutants of calls need one, those of other families ({}) do not"
)
_PYPROJECT, _OWN = "pyproject.toml", "mutabot.toml"
_INIT = "run `mutabot init` to propose one"
_BYTES = pydantic.TypeAdapter(pydantic.ByteSize)
#: signs of a path, and bytes of a name in it, that a file system takes
_LONGEST_PATH, _LONGEST_NAME = 4000, 255
#: bytes that Python and pytest need
_LEAST_MEMORY = 100_000_000
_WILD = re.compile(r"[*?\[]")


def _amount(value: Any, *, least: int, example: str) -> Any:
    """Return the bytes in a text such as ``4 GB`` or ``512 MiB``; whole numbers are bytes already."""
    if isinstance(value, str):
        try:
            value = int(_BYTES.validate_python(value if value.strip(" .0123456789") else ""))
        except (pydantic.ValidationError, OverflowError):
            raise ValueError(
                f"{shortened(value)!r} is not a number of bytes; write it like {example}"
            ) from None
    if isinstance(value, int) and not isinstance(value, bool) and value < least:
        raise ValueError(f"{value} bytes are too little; write it like {example}")
    return value


def _known_family(name: str) -> str:
    why = why_unknown(name)
    if why is not None:
        raise ValueError(why)
    return name


class _FamilyNames:
    """The JSON schema of a list of families, made when it is asked for, as it loads packages."""

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: pydantic.GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {"enum": list(known_families())}


def _moment(text: str) -> str:
    Moment.parse_any(text)
    return text


def _node_name(name: str) -> str:
    if not name.startswith(("/", "*")):
        raise ValueError(f"{name!r} is not resolved: the name of a node begins with /, such as '/{name}'")
    return name


_NodeName = Annotated[str, AfterValidator(_node_name)]
_Texts = Annotated[tuple[str, ...], Field(strict=False)]
_SomeTexts = Annotated[tuple[str, ...], Field(strict=False, min_length=1)]
_Family = Annotated[str, AfterValidator(_known_family), _FamilyNames()]
_SelectedFamilies = Annotated[tuple[_Family, ...], Field(strict=False, min_length=1)]
_MomentText = Annotated[str, AfterValidator(_moment)]
_Moments = Annotated[tuple[_MomentText, ...], Field(strict=False, min_length=1)]
_Memory = BeforeValidator(partial(_amount, least=_LEAST_MEMORY, example="'4 GB'"))
_Room = BeforeValidator(partial(_amount, least=0, example="'200 MB', or 0 for none"))
_Share = Annotated[float, Field(ge=0, le=1)]


class Settings(Table):
    """The keys a user can write, beside the tables that packages bring."""

    program: _SomeTexts
    """Files and folders of the robot program, also as globs. Calls in them have the role `program`.

        program = ["mission.py", "cell/*.py"]
    """
    oracle: _Texts = ()
    """The same for code of the tests that takes readings for their own checks: role `oracle`.

        oracle = ["tests/sensors.py"]
    """
    oracle_nodes: Annotated[tuple[_NodeName, ...], Field(strict=False)] = ()
    """The tests' own nodes, by resolved names; `*` stands for any text. What is done in them under a name has
    the role `oracle`.

        oracle_nodes = ["/checker*"]
    """
    tests: _SomeTexts = ("tests",)
    """Pytest's arguments that say which tests there are. Without it, what pytest's own `testpaths` names
    counts, as for plain pytest.

        tests = ["tests", "acceptance/test_cell.py"]
    """
    vocabulary: _Texts = ()
    """[Vocabulary](vocabulary.md) files of the project, or names of shipped ones. Mutants of calls need one.

        vocabulary = ["robot.toml"]
    """
    rounds: Annotated[int, Field(ge=1, le=options.ROUNDS)] = 1
    """How often everything is repeated, each time with other seeds (`--rounds`).

        rounds = 5
    """
    seed: Annotated[int, Field(ge=0, le=options.SEED)] = 1
    """The campaign's seed, from which those of all rounds and tests come (`--seed`).

        seed = 42
    """
    jobs: Annotated[int, Field(ge=1, le=options.JOBS)] | None = None
    """Runs at a time (`--jobs`); by default one per core.

        jobs = 1
    """
    timeout_factor: Annotated[float, Field(gt=1, le=options.FACTOR)] = 10.0
    """How many times what a test takes on the original it may take with a mutant:
    [limits of time](verdicts.md#limits-of-time).

        timeout_factor = 3.0
    """
    timeout_seconds: Annotated[float, Field(gt=0, le=options.SECONDS)] | None = None
    """Seconds that every test may take at least, by the clock and of processor time; without, by
    [limits of time](verdicts.md#limits-of-time).

        timeout_seconds = 300.0
    """
    private_files: bool = True
    """Whether each run of the tests has [files of its own](shared-state.md#files).

        private_files = false
    """
    evidence: Annotated[int, Field(le=options.BYTES), _Room] = 200_000_000
    """Room for [recordings](evidence.md#where-it-is-kept) of what the robot did. 0 records nothing.

        evidence = "1 GB"
    """
    memory: Annotated[int, Field(le=options.BYTES), _Memory] = 4_000_000_000
    """Address space of a process, as a text with a unit or in bytes.

        memory = "16 GB"
    """
    unstable_limit: _Share = 0.1
    """Share of outcomes that may be unstable; above it, `run` ends with 4.

        unstable_limit = 0.0
    """
    timeout_limit: _Share = 1.0
    """Share of outcomes that may be time-outs; above it, `run` ends with 5.

        timeout_limit = 0.2
    """
    error_limit: _Share = 0.0
    """Share of outcomes that may be errors; above it, `run` ends with 4.

        error_limit = 0.05
    """
    min_score: Annotated[float, Field(ge=0, le=100)] | None = None
    """Least score in percent of each family and role (`--min-score`); below it, `run` ends with 1.

        min_score = 80.0
    """
    pytest_args: _Texts = ()
    """Further arguments for pytest.

        pytest_args = ["-m", "not slow"]
    """
    when: _Moments = (EVERY,)
    """At which calls of its site a mutant acts, [a mutant each](thresholds.md#when-in-time).

        when = ["every", "once", "from 10"]
    """
    families: _SelectedFamilies = USUAL
    """[Families](operators.md) of mutants to run (`--family`).

        families = ["robot", "conventional"]
    """
    baseline_repetitions: Annotated[int, Field(ge=1, le=options.BASELINES)] | None = None
    """How often the original is run per round, to [find flaky tests](verdicts.md#a-second-look); by default
    as often as the engine needs.

        baseline_repetitions = 10
    """
    repeats: bool = True
    """Whether [kills that may be a coincidence](verdicts.md#a-second-look) are re-run.

        repeats = false
    """
    demand: Annotated[tuple[dict[str, Any], ...], Field(strict=False)] = ()
    """How big a fault the tests must notice, [a table each](thresholds.md#demands); else `run` ends with 1.

        demand = [{ site = "mission.py:38", quantity = "y", notice = "5 mm" }]
    """


class Configuration(Settings):
    """The configuration of a campaign: the settings, with paths expanded and sorted.

    Attributes:
        root: absolute path of the project.
        file: the file it was read from, relative to ``root``.
        demands: what ``demand`` says, checked.
        tables: the tables of packages that it has, by name.
    """

    root: Path
    file: str
    demands: tuple[Demand, ...] = ()
    tables: Mapping[str, Table] = {}


def load_configuration(
    folder: Path, families: Collection[str] = (), overrides: Sequence[str] = ()
) -> Configuration:
    """Return the configuration of the project in ``folder``.

    ``families``: those that are asked for instead of those that it names. ``overrides``: keys that the
    command line sets, as ``KEY=VALUE``.

    Raises ConfigurationError or UnknownNameError: the first mistake, with a message that names all.
    """
    place = _find(folder)
    found = _checked(place, folder, families, ())
    if not overrides:
        return found
    # the file is without a mistake, so what is wrong now is wrong with what the command line says
    flags = " ".join(f"-o {text}" for text in overrides)
    stated = DocumentPlace(Document(flags, place.document.data, {}, ConfigurationError), path=place.path)
    return _checked(stated, folder, families, overrides).model_copy(update={"file": found.file})


def _checked(
    place: DocumentPlace, folder: Path, families: Collection[str], overrides: Sequence[str]
) -> Configuration:
    given: Any = place.document.data
    for part in place.path:
        given = given[part]
    if not isinstance(given, dict):
        place.table(Settings, given)
        raise_errors(place.errors)
    models = _tables_of_packages(given, overrides)
    lists = {f"{name}.{key}" for name, model in models.items() for key in model.lists()}
    raw = overridden(given, overrides, lists | Settings.lists())
    if place.document.file == _OWN and isinstance(raw.get("tool"), dict) and "mutabot" in raw["tool"]:
        (place / "tool" / "mutabot").error(f"in {_OWN} the keys are at the top level, without [tool.mutabot]")
        raise_errors(place.errors)
    own = _without(raw, models, place)
    known = brought("tables", Settings.model_fields) if own.keys() - Settings.model_fields.keys() else ()
    settings = place.table(Settings, own, salvage=True, also=known)
    if settings is None:
        raise_errors(place.errors)
        raise AssertionError("a table without a mistake is refused")
    if "tests" not in raw:
        settings = settings.model_copy(update={"tests": test_paths(folder) or settings.tests})
    paths = _Paths(folder.resolve())
    program = paths.sources(place / "program", settings.program)
    oracle = paths.sources(place / "oracle", settings.oracle)
    _refuse_overlap(place / "oracle", program, oracle)
    paths.check(place, settings, has_tests="tests" in raw)
    if not settings.vocabulary and need_vocabulary(families or settings.families):
        others = ", ".join(families_brought(without_vocabulary=True)) or "there are none"
        at = place / "vocabulary" if "vocabulary" in raw else place
        at.error(_NO_VOCABULARY.format(others))
    tables = {}
    for name in sorted(models.keys() & raw.keys()):
        table = (place / name).table(models[name], raw[name])
        if table is not None:
            tables[name] = table
            for key in table.paths():
                paths.check_patterns(place / name / key, getattr(table, key))
    demands = check_demands(place / "demand", settings.demand)
    raise_errors(place.errors)
    changed = {"program": program, "oracle": oracle, "root": folder.resolve(), "file": place.document.file}
    return Configuration(**{**dict(settings), **changed, "demands": demands, "tables": tables})


def _tables_of_packages(given: dict[str, Any], overrides: Sequence[str]) -> dict[str, type[Table]]:
    """Return the classes of the packages' tables that the file contains or the command line sets."""
    named = {text.partition("=")[0].partition(".")[0].strip() for text in overrides}
    named |= given.keys()
    if not named - Settings.model_fields.keys():
        return {}
    found = brought("tables", Settings.model_fields).items()
    return {name: part.load_class(Table) for name, part in found if name in named}


def _without(raw: dict[str, Any], models: Collection[str], place: DocumentPlace) -> dict[str, Any]:
    """Return the keys of the core. Note tables of packages that are not installed as mistakes."""
    own = {key: value for key, value in raw.items() if key not in models}
    for key in own.keys() - Settings.model_fields.keys():
        why = not_installed(key, "tables")
        if why is not None:
            (place / key).error(why)
            del own[key]
    return own


def _find(folder: Path) -> DocumentPlace:
    """Return where the keys of the configuration stand."""
    if not folder.is_dir():
        raise ConfigurationError("there is no such folder", file=str(folder))
    found: list[DocumentPlace] = []
    hint = ""
    if (folder / _PYPROJECT).exists():
        document = Document.read(folder / _PYPROJECT, _PYPROJECT, ConfigurationError)
        tool = document.data.get("tool", {})
        if isinstance(tool, dict) and "mutabot" in tool:
            found.append(DocumentPlace(document, path=("tool", "mutabot")))
        near = nearest_name("mutabot", tool) if isinstance(tool, dict) else None
        hint = f" (there is [tool.{near}]; did you mean [tool.mutabot]?)" if near else ""
    if (folder / _OWN).exists():
        found.append(DocumentPlace(Document.read(folder / _OWN, _OWN, ConfigurationError)))
    if not found:
        problem = f"no [tool.mutabot] in {_PYPROJECT} and no {_OWN} in {folder}{hint}; {_INIT}"
        raise ConfigurationError(problem)
    if len(found) > 1:
        found[0].error(f"there is also {_OWN}; keep the configuration in one of the two")
        raise_errors(found[0].errors)
    return found[0]


class _Paths:
    """Checks paths of a configuration: they must lie in the project and exist."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def sources(self, place: DocumentPlace, names: tuple[str, ...]) -> tuple[str, ...]:
        """Return files and folders, relative to the root, sorted; globs expanded."""
        found: set[str] = set()
        for index, name in enumerate(names):
            found.update((place / index).attempt(self._fitting, name, only_sources=True) or ())
        return tuple(sorted(found))

    def check(self, place: DocumentPlace, settings: Settings, *, has_tests: bool) -> None:
        """Note mistakes in the paths of the tests and the vocabulary."""
        for index, argument in enumerate(settings.tests):
            after_option = index > 0 and settings.tests[index - 1].startswith("-")
            name = argument.partition("::")[0]
            if argument.startswith("-") or after_option:
                continue
            if has_tests:
                (place / "tests" / index).attempt(self._existing, name)
            elif not (self.root / name).exists():
                text = f'there is no folder {name!r}; say where the tests are: tests = ["…"]'
                (place / "tests").error(text)
        for index, name in enumerate(settings.vocabulary):
            (place / "vocabulary" / index).attempt(self._inside, name)

    def check_patterns(self, place: DocumentPlace, names: tuple[str, ...]) -> None:
        """Note each path or pattern that matches nothing."""
        for index, name in enumerate(names):
            (place / index).attempt(self._fitting, name)

    def _inside(self, name: str) -> str:
        """Return a path in the project. Raises ValueError for any other."""
        path = PurePosixPath(name)
        if not name.strip():
            raise ValueError("is an empty path; name a file or folder of the project")
        if len(name) > _LONGEST_PATH or any(len(os.fsencode(part)) > _LONGEST_NAME for part in path.parts):
            raise ValueError(f"{shortened(name)!r} is too long for a path")
        if "\0" in name:
            raise ValueError(f"{name!r} is not a path: it holds a NUL character")
        if path.is_absolute() or name.startswith("~"):
            raise ValueError(f"{name!r} must be relative to the project's folder")
        if ".." in path.parts or not (self.root / path).resolve().is_relative_to(self.root):
            raise ValueError(f"{name!r} leads out of the project's folder; only what lies in it can be named")
        return name

    def _existing(self, name: str) -> str:
        """Return the path of a file or folder in the project. Raises ValueError if there is none."""
        if (self.root / self._inside(name)).exists():
            return name
        near = self._nearest(name)
        raise ValueError(f"there is no {name!r}{f'; did you mean {near!r}?' if near else ''}")

    def _fitting(self, name: str, *, only_sources: bool = False) -> list[str]:
        """Return what a path or pattern matches, relative to the root. Raises ValueError if that is nothing.

        ``only_sources``: of what a pattern fits, only Python files and folders.
        """
        if not _WILD.search(self._inside(name)) or (self.root / name).exists():
            return [PurePosixPath(self._existing(name)).as_posix()]
        try:
            found = [match.relative_to(self.root) for match in self.root.glob(name)]
        except (ValueError, NotImplementedError) as error:
            raise ValueError(f"{name!r} is not a pattern of paths: {error}") from None
        found = [path for path in found if not only_sources or _is_source(self.root, path)]
        if not found:
            raise ValueError(f"{name!r} matches {'no Python file or folder' if only_sources else 'nothing'}")
        return [path.as_posix() for path in found]

    def _nearest(self, name: str) -> str | None:
        folder = (self.root / name).parent
        while not folder.is_dir():
            folder = folder.parent
        known = [path.relative_to(self.root).as_posix() for path in _visible(folder)]
        return nearest_name(name, known)


def _refuse_overlap(place: DocumentPlace, program: tuple[str, ...], oracle: tuple[str, ...]) -> None:
    """Note each part of the oracle that belongs to the program as well."""
    for path, other in product(oracle, program):
        oracle_part, program_part = PurePosixPath(path), PurePosixPath(other)
        if oracle_part.is_relative_to(program_part) or program_part.is_relative_to(oracle_part):
            place.error(f"{path!r} overlaps program ({other!r}); a call is the program's or the tests'")


def _is_source(root: Path, path: Path) -> bool:
    hidden = any(part.startswith(".") or part == "__pycache__" for part in path.parts)
    return not hidden and (path.suffix == ".py" or (root / path).is_dir())


def _visible(folder: Path) -> Iterator[Path]:
    return (path for path in sorted(folder.iterdir()) if not path.name.startswith((".", "__")))
