"""The content of installed packages whose code takes part in a run.

A version identifies the content of an installed package, unless it is under development: one that is
installed editable, or brings parts of mutabot, counts by the content of its files, of whatever kind they are.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from importlib.metadata import Distribution, distributions
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import unquote, urlsplit

from mutabot.execution.versions import name_and_version
from mutabot.extensions import GROUP, references

from .snapshot import Snapshot, _digest_of

#: folders in which packages of many lie side by side
_SHARED = {"site-packages", "dist-packages"}
#: metadata of a distribution: its version is known without it
_OF_INSTALLERS = (".dist-info", ".egg-info", "__pycache__")


def code_of_packages(root: Path) -> dict[str, tuple[tuple[str, str], ...]]:
    """Return the files of each package that counts by content, with digests, except the project's own."""
    found: dict[str, tuple[tuple[str, str], ...]] = {}
    for distribution in distributions():
        name, _ = name_and_version(distribution)
        if not name or name == GROUP or name in found:  # of several, Python uses the first
            continue
        places = set(_places(distribution, name))
        if places:
            files = {str(path): digest for place in places for path, digest in _files(place, root)}
            found[name] = tuple(sorted(files.items()))
    return found


def _places(distribution: Distribution, name: str) -> Iterator[Path]:
    """Yield the files and folders of a distribution whose code counts by content."""
    editable = _editable(distribution)
    if editable is not None:
        yield editable
    entries = [entry.module for entry in distribution.entry_points if entry.group == GROUP]
    if not entries:
        return
    for file in distribution.files or ():
        if not any(part.endswith(_OF_INSTALLERS) for part in file.parts):
            yield Path(str(distribution.locate_file(file)))
    named = (*entries, *(reference.partition(":")[0] for reference in references(name)))
    for module in {reference.partition(".")[0] for reference in named}:
        yield from _of_module(module)


def _of_module(name: str) -> Iterator[Path]:
    """Yield the folder of a package, or the file of a module and the files beside it."""
    spec = find_spec(name)
    if spec is None:
        return
    found = [*(spec.submodule_search_locations or ()), *([spec.origin] if spec.has_location else [])]
    for place in map(Path, filter(None, found)):
        top = place if place.is_dir() or spec.submodule_search_locations is None else place.parent
        # helpers may be modules beside it; among the packages of others its distribution lists them
        yield top if top.parent.name in _SHARED else top.parent


def _editable(distribution: Distribution) -> Path | None:
    """Return the folder in which an editable distribution is developed; None for any other distribution."""
    try:
        direct_url = json.loads(distribution.read_text("direct_url.json") or "{}")
        is_editable, address = bool(direct_url["dir_info"]["editable"]), urlsplit(direct_url["url"])
    except (ValueError, KeyError, TypeError, OSError):
        return None
    return Path(unquote(address.path)) if is_editable and address.scheme == "file" else None


def _files(place: Path, root: Path) -> Iterable[tuple[Path, str]]:
    """Yield files with their digests, except those below the project's root, which are its own."""
    if place.is_file():
        digest = _digest_of(place)
        found = {place: digest} if digest is not None else {}
    elif place.resolve().is_relative_to(root) or not place.is_dir():
        found = {}
    else:
        found = {place / name: digest for name, digest in Snapshot.take(place).digests.items()}
    return [(path, digest) for path, digest in found.items() if not path.resolve().is_relative_to(root)]
