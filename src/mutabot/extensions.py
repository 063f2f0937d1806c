"""Packages beside the core: what they bring, and how it is found.

A package declares an ``Extension`` under the entry point group ``mutabot``. Every part of it is named by a
reference, ``module:attribute`` or ``module``, and imported only when it is used. Entry points are read once,
by the controller; processes of the tests are told the references they need (``told_to_processes``, ``use``),
since reading entry points is slow.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .errors import ExtensionError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

#: version of this interface: raised when a package written for an older one would break
INTERFACE = 1
GROUP = "mutabot"
#: kinds of parts that processes of the tests need
_OF_PROCESSES = ("operators", "middlewares")


@dataclass(frozen=True, slots=True)
class Extension:
    """What a package brings.

    Attributes:
        interface: the version of this interface that the package was written for.
        operators: subclasses of ``mutabot.Operator``, by the operators' names.
        middlewares: modules with hooks, by the name of the module whose import puts them in place.
        vocabularies: files ``package:file.toml``, by the names that projects use for them.
        versions: distributions whose versions decide how tests end; a campaign's journal notes them.
        faults: subclasses of ``mutabot.faults.FaultProvider``, by the providers' names.
    """

    interface: int
    operators: Mapping[str, str] = field(default_factory=dict)
    middlewares: Mapping[str, str] = field(default_factory=dict)
    vocabularies: Mapping[str, str] = field(default_factory=dict)
    versions: tuple[str, ...] = ()
    faults: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Part:
    """One thing that a package brings.

    Attributes:
        name: its name among those of its kind.
        reference: ``module:attribute`` or ``module``; of a file ``package:file``.
        owner: the distribution that brings it.
    """

    name: str
    reference: str
    owner: str

    def load(self) -> Any:
        """Import it. Raises ExtensionError, naming the part and its package, if that fails."""
        module, _, attribute = self.reference.partition(":")
        try:
            found: Any = import_module(module)
            for name in attribute.split(".") if attribute else ():
                found = getattr(found, name)
        except Exception as error:  # a package of others may fail in any way
            text = f"{self.name!r} of package {self.owner!r} ({self.reference}) cannot be loaded: {error!r}"
            raise ExtensionError(text) from error
        return found

    @property
    def file(self) -> Path:
        """The file that the reference names; the package is not imported. Raises ExtensionError."""
        package, _, name = self.reference.partition(":")
        spec = find_spec(package)
        for folder in (spec.submodule_search_locations or ()) if spec is not None else ():
            if (found := Path(folder, name)).is_file():
                return found
        raise ExtensionError(f"{self.name!r} of package {self.owner!r}: there is no file {self.reference}")


class _Told:
    """What the controller has told this process; None in the controller itself."""

    parts: Mapping[str, Mapping[str, str]] | None = None


def brought(kind: str) -> dict[str, Part]:
    """All parts of a kind, by name; those of mutabot's own packages first, then by package and name.

    Raises ExtensionError for a package that cannot be used, and for two parts of one name.
    """
    if _Told.parts is not None:
        told = _Told.parts.get(kind, {})
        return {name: Part(name, reference, "the controller") for name, reference in told.items()}
    found: dict[str, Part] = {}
    for owner, extension in _declared():
        for name, reference in getattr(extension, kind).items():
            if name in found:
                text = f"{name!r} of package {owner!r} has the name of one of {found[name].owner!r} ({kind})"
                raise ExtensionError(text)
            found[name] = Part(name, reference, owner)
    return found


def versions() -> tuple[str, ...]:
    """Distributions whose versions decide how tests end, by the packages that say so."""
    return tuple(dict.fromkeys(name for _, extension in _declared() for name in extension.versions))


def told_to_processes() -> dict[str, dict[str, str]]:
    """The references that processes of the tests need, by kind and name."""
    return {kind: {name: part.reference for name, part in brought(kind).items()} for kind in _OF_PROCESSES}


def use(parts: Mapping[str, Mapping[str, str]]) -> None:
    """In a process of the tests: these parts, as the controller found them, are all there are."""
    _Told.parts = parts


@cache
def _declared() -> tuple[tuple[str, Extension], ...]:
    """Every extension, with the distribution that it comes from; mutabot's own first."""
    from importlib import metadata  # noqa: PLC0415  # slow, and most commands do not need it

    found = [(_owner(entry), entry) for entry in metadata.entry_points(group=GROUP)]
    return tuple((owner, _read(owner, entry)) for owner, entry in _in_order(found))


def _in_order(found: Iterable[tuple[str, EntryPoint]]) -> list[tuple[str, EntryPoint]]:
    return sorted(found, key=lambda one: (one[0] != GROUP, one[0], one[1].name))


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
