"""Packages beside the core: what they bring, and how they are found.

A package declares an ``Extension`` under the entry point group ``mutabot``. Every part of it is named by a
reference, ``module:attribute`` or ``module``, and imported only when it is used. Entry points are read once,
by the controller, since that is slow; processes of the tests get the references that they need
(``references_for_processes``, ``use``).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import field
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, TypeVar

from mutabot.frozen import frozen

from .errors import ExtensionError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint
    from pathlib import Path

#: version of this interface: raised when a package written for an older one would break
INTERFACE = 2
GROUP = "mutabot"
#: what comes with mutabot's own packages: a message says which one is not installed
_OF_OWN_PACKAGES = {
    "commands": {
        "diff": "mutabot_languages",
        "export": "mutabot_languages",
        "init": "mutabot_init",
        "live": "mutabot_live",
        "minimal": "mutabot_minimal",
        "motion": "mutabot_motion",
        "patches": "mutabot_patches",
        "suggest": "mutabot_suggest",
        "world": "mutabot_world",
    },
    "executors": {"cluster": "mutabot_dask"},
    "tables": {
        "cluster": "mutabot_dask",
        "guard": "mutabot_hardware",
        "hardware": "mutabot_hardware",
        "patches": "mutabot_patches",
        "world": "mutabot_world",
    },
    "operators": dict.fromkeys(("catalogue", "middleware"), "mutabot_catalogue"),
}
#: kinds of parts that processes of the tests need
_OF_PROCESSES = ("operators", "middlewares", "environments", "futures", "failures", "languages")
#: kinds of parts that are code or data of a package
_REFERRING = (
    *_OF_PROCESSES, "vocabularies", "executors", "templates", "tables", "commands", "formats", "sections",
    "simulations", "faults", "guards",
)  # fmt: skip
#: those that are modules of the packages themselves
_OWN = ("operators", "middlewares", "environments")


T = TypeVar("T")


@frozen
class Described:
    """A part that ``--help`` lists without importing it.

    Attributes:
        reference: ``module:attribute``.
        help: what it does, in one sentence.
        metavar: what stands for the value of an option.
        before: the command before which ``--help`` lists a command; it stands last without.
    """

    reference: str
    help: str
    metavar: str = "TEXT"
    before: str = ""


@frozen
class Extension:
    """The description of all that a package brings.

    Attributes:
        interface: the version of this interface that the package was written for.
        operators: subclasses of ``ValueOperator`` or ``CommandOperator`` of ``mutabot.api.faults``, by the
            operators' names.
        middlewares: modules that keep ``runtime.targets.target.MiddlewareModule``, by the name of the client
            library's module whose import puts their hooks in place.
        environments: modules that keep ``runtime.targets.target.Environment``, by any name.
        futures: classes of futures, by the name under which recorded answers keep them: one that is made
            without arguments is not done until it is completed.
        failures: classes of exceptions, by any name, that come from the tools around a program and never from
            the program: a run that met one is an error.
        libraries: client libraries, by the name of the top-level package, in which ``*`` stands for any
            text. What a program does through them has names on a middleware: ``mutabot init`` proposes none
            of their callables as operations, but for these functions.
        vocabularies: files ``package:file.toml``, by the names that projects use for them.
        versions: distributions whose versions decide how tests end; a campaign's journal notes them.
        executors: subclasses of ``mutabot.campaign.request.ExecutorChoice``. One named ``cluster``
            gives commands that run campaigns an option ``--cluster``, whose value says where.
        templates: functions that make a starting project of an option's value: a mapping of its files' names
            (relative, with ``/``) to their texts. One named ``cell`` gives ``mutabot init`` an option
            ``--cell``. They raise ``mutabot.errors.UsageError`` for a value that they do not know.
        tables: subclasses of ``mutabot.api.processes.Table``, by the table's name in the configuration.
        commands: sub-commands: functions; ``mutabot.cli.parameters`` says what their parameters stand for.
        formats: a function (``mutabot.report.format.Format``) each, by its name.
        sections: functions of ``mutabot.results.results.Results`` that make a section of the results
            document each, of plain data, by its name; None for no section.
        simulations: subclasses of ``mutabot.api.processes.SimulatedMiddleware``, by their names: what
            campaigns may run the tests over instead of the real middleware.
        faults: subclasses of ``mutabot.faults.FaultProvider``, by the providers' names.
        languages: objects that keep ``mutabot.languages.front_end.FrontEnd``, by the languages' names: robot
            programs in them run in an interpreter that is written in Python.
        guards: subclasses of ``mutabot.api.processes.CallGuard``, by the names of the tables that they get: a
            project whose configuration has such a table has the guard before every operation.
    """

    interface: int
    operators: Mapping[str, str] = field(default_factory=dict)
    middlewares: Mapping[str, str] = field(default_factory=dict)
    environments: Mapping[str, str] = field(default_factory=dict)
    futures: Mapping[str, str] = field(default_factory=dict)
    failures: Mapping[str, str] = field(default_factory=dict)
    libraries: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    vocabularies: Mapping[str, str] = field(default_factory=dict)
    versions: tuple[str, ...] = ()
    executors: Mapping[str, Described] = field(default_factory=dict)
    templates: Mapping[str, Described] = field(default_factory=dict)
    tables: Mapping[str, str] = field(default_factory=dict)
    commands: Mapping[str, Described] = field(default_factory=dict)
    formats: Mapping[str, str] = field(default_factory=dict)
    sections: Mapping[str, str] = field(default_factory=dict)
    simulations: Mapping[str, str] = field(default_factory=dict)
    faults: Mapping[str, str] = field(default_factory=dict)
    languages: Mapping[str, str] = field(default_factory=dict)
    guards: Mapping[str, str] = field(default_factory=dict)


@frozen
class ExtensionPart:
    """A part that a package brings.

    Attributes:
        name: its name among those of its kind.
        reference: ``module:attribute`` or ``module``; of a file ``package:file``.
        owner: the distribution that brings it.
        help, metavar, before: as in ``Described``; empty for what is not.
    """

    name: str
    reference: str
    owner: str
    help: str = ""
    metavar: str = ""
    before: str = ""

    def load(self) -> Any:
        """Import it. Raises ExtensionError, naming the part and its package, if that fails."""
        module, _, attribute = self.reference.partition(":")
        try:
            found: Any = import_module(module)
            for name in attribute.split(".") if attribute else ():
                found = getattr(found, name)
        except Exception as error:  # a package of others may fail in any way
            raise ExtensionError(f"{self.text} cannot be loaded: {error!r}") from error
        return found

    def load_function(self) -> Callable[..., Any]:
        """Load the object as a function. Raises ExtensionError also if it is not one."""
        found = self.load()
        if not callable(found):
            raise ExtensionError(f"{self.text} is not a function")
        return found  # type: ignore[no-any-return]

    @property
    def file(self) -> Path:
        """The file that the reference names; the package is not imported. Raises ExtensionError."""
        from pathlib import Path  # noqa: PLC0415  # of no use to processes below the tests

        package, _, name = self.reference.partition(":")
        spec = find_spec(package)
        for folder in (spec.submodule_search_locations or ()) if spec is not None else ():
            if (found := Path(folder, name)).is_file():
                return found
        raise ExtensionError(f"{self.name!r} of package {self.owner!r}: there is no file {self.reference}")

    def load_class(self, base: type[T]) -> type[T]:
        """Load the object as a class. Raises ExtensionError also if it is not a subclass of ``base``."""
        found = self.load()
        if not (isinstance(found, type) and issubclass(found, base)):
            raise ExtensionError(f"{self.text} is not a subclass of {base.__module__}.{base.__qualname__}")
        return found

    def make(self, base: type[T]) -> T:
        """Return an object of that class. Raises ExtensionError also if its ``name`` is another one."""
        kind = self.load_class(base)
        try:
            made = kind()
        except Exception as error:  # as above
            raise ExtensionError(f"{self.text} cannot be made: {error!r}") from error
        name = getattr(made, "name", None)
        if name != self.name:
            raise ExtensionError(f"{self.text} calls itself {name!r}; extension and class must agree")
        return made

    @property
    def text(self) -> str:
        """The part's name in messages."""
        return f"{self.name!r} of package {self.owner!r} ({self.reference})"


class _SentParts:
    """The parts of packages that the controller has sent to this process; None in the controller itself."""

    parts: Mapping[str, Mapping[str, ExtensionPart]] | None = None


def brought(kind: str, own: Collection[str] = ()) -> Mapping[str, ExtensionPart]:
    """Return all parts of a kind, by name; those of mutabot's own packages first, then by package and name.

    ``own``: the names of what the core itself has of this kind.

    Raises ExtensionError for a package that cannot be used, and for two parts of one name.
    """
    if _SentParts.parts is not None:
        return _SentParts.parts.get(kind, {})
    found: dict[str, ExtensionPart] = {}
    for owner, extension in _declared():
        for name, declared in getattr(extension, kind).items():
            other = found[name].owner if name in found else GROUP if name in own else None
            if other is not None:
                raise ExtensionError(
                    f"{name!r} of package {owner!r} has the name of one of {other!r} ({kind})"
                )
            found[name] = _part(name, declared, owner)
    return found


def versions() -> tuple[str, ...]:
    """Return the distributions that packages declare as deciding how tests end."""
    return tuple(dict.fromkeys(name for _, extension in _declared() for name in extension.versions))


def references(owner: str) -> tuple[str, ...]:
    """Return all references of a distribution's extensions; available only in the controller."""
    found = (extension for name, extension in _declared() if name.lower() == owner)
    return tuple(
        part if isinstance(part, str) else part.reference
        for extension in found
        for kind in _REFERRING
        for part in getattr(extension, kind).values()
    )


def _part(name: str, declared: str | Described, owner: str) -> ExtensionPart:
    if isinstance(declared, str):
        return ExtensionPart(name, declared, owner)
    return ExtensionPart(name, declared.reference, owner, declared.help, declared.metavar, declared.before)


def not_installed(name: str, kind: str) -> str | None:
    """Return the message for a missing part of one of mutabot's own packages; None for any other part."""
    package = _OF_OWN_PACKAGES.get(kind, {}).get(name)
    if package is None or name in (found := brought(kind)):
        return None
    if any(package == package_of(part.reference) for part in found.values()):  # a family of its operators
        return None
    return f"comes with the package {package}, which is not installed"


def references_for_processes(languages: Collection[str] = ()) -> dict[str, dict[str, str]]:
    """Return the references that processes of the tests need, by kind and name.

    ``languages``: those of the program beside Python. What reads others need not be there, nor be loaded.
    """
    return {
        kind: {
            name: part.reference
            for name, part in brought(kind).items()
            if kind != "languages" or name in languages
        }
        for kind in _OF_PROCESSES
    }


def use(parts: Mapping[str, Mapping[str, str]]) -> None:
    """Use only these parts, which the controller has found, in a process of the tests."""
    _SentParts.parts = {
        kind: {name: ExtensionPart(name, at, package_of(at)) for name, at in declared.items()}
        for kind, declared in parts.items()
    }


def libraries() -> dict[str, tuple[str, ...]]:
    """Return the client libraries of middlewares, with their functions that are operations.

    Only the controller knows.
    """
    found: dict[str, tuple[str, ...]] = {}
    for _, extension in _declared():
        for name, functions in extension.libraries.items():
            found[name] = (*found.get(name, ()), *functions)
    return found


def packages() -> frozenset[str]:
    """Return the top-level packages of mutabot and its parts, whose own calls are not the program's."""
    references = (part.reference for kind in _OWN for part in brought(kind).values())
    return frozenset({GROUP, *map(package_of, references)})


def package_of(reference: str) -> str:
    """Return the top-level package of a reference, ``module:name``."""
    return reference.partition(":")[0].partition(".")[0]


@cache
def _declared() -> tuple[tuple[str, Extension], ...]:
    """Return every extension, with the distribution that it comes from; mutabot's own first."""
    from importlib import metadata  # noqa: PLC0415  # slow, and most commands do not need it

    found = [(_owner(entry), entry) for entry in metadata.entry_points(group=GROUP)]
    return tuple(
        (owner, _read(owner, entry))
        for owner, entry in sorted(
            found, key=lambda found_entry: (found_entry[0] != GROUP, found_entry[0], found_entry[1].name)
        )
        # each package of our own can be left out
        if owner != GROUP or find_spec(entry.module.partition(".")[0]) is not None
    )


def _owner(entry: EntryPoint) -> str:
    return entry.dist.name if entry.dist is not None else entry.value


def _read(owner: str, entry: EntryPoint) -> Extension:
    where = f"package {entry.name!r} of {owner!r} ({entry.value})"
    try:
        found = entry.load()
    except Exception as error:  # as above
        raise ExtensionError(f"{where} cannot be loaded: {error!r}") from error
    if not isinstance(found, Extension):
        raise ExtensionError(f"{where} is {type(found).__name__}, not a mutabot.extensions.Extension")
    if found.interface != INTERFACE:
        raise ExtensionError(
            f"{where} was written for version {found.interface} of the extension interface; this mutabot has "
            f"version {INTERFACE}: install versions that fit together, or uninstall {owner!r}"
        )
    return found
