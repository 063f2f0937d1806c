"""The parameters that ``mutabot init`` proposes, by name, from the worlds that the tests have made."""

from __future__ import annotations

import json
import sys
import tomllib
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from glob import escape
from importlib import import_module
from pathlib import Path
from typing import Any, TypeAlias

import wrapt

from .patching import wrap

#: parameters of each kind that are proposed by the names of things; of more things, all together
_MOST = 4
#: libraries of simulation; of each this package has a file and a module of its name
_LIBRARIES = ("mujoco", "pybullet")
#: names of things, by library and parameter
_Names: TypeAlias = dict[str, dict[str, list[str]]]


class WorldProposer:
    """Proposes parameters of the simulated world."""

    def watch(self) -> Callable[[], Any]:
        """Record the names of things in each world of these libraries that this process makes."""
        names: _Names = {}

        def note(library: str, _: Any, world: Any) -> None:
            with suppress(Exception):  # looking at a world must not disturb the program
                _add(names, library, import_module(f"{__package__}.{library}").offered_parameters(world))

        def begin(library: str, _: Any) -> None:
            shipped = _shipped(library)
            makers = (target for table in (shipped, *shipped["parameter"]) for target in table.get("of", ()))
            for reference in dict.fromkeys(makers):
                with suppress(LookupError):
                    wrap(reference, after=partial(note, library))

        for library in _LIBRARIES:
            wrapt.register_post_import_hook(partial(begin, library), library)
        return lambda: {"names": names, "files": [*_files_of_packages()] if names else []}

    def lines(self, seen: Sequence[Any]) -> list[str]:
        """Return the lines of table ``world``: a package's parameter file, or one parameter per thing."""
        files = list(dict.fromkeys(name for seen_report in seen for name in seen_report["files"]))
        names: _Names = {}
        for report in seen:
            for library, found in report["names"].items():
                _add(names, library, found.items())
        if not names:
            return []
        head = ["", "[world]  # `mutabot run --family world` disturbs the simulated world"]
        return [*head, f"parameters = {json.dumps(files)}"] if files else [*head, *_parameters(names)]


PROPOSER = WorldProposer()


def _shipped(library: str) -> dict[str, Any]:
    return tomllib.loads(Path(__file__).with_name(f"{library}.toml").read_text(encoding="utf-8"))


def _add(names: _Names, library: str, things: Any) -> None:
    for kind, found in things:
        known = names.setdefault(library, {}).setdefault(kind, [])
        known += [name for name in found if name and name not in known]


def _files_of_packages() -> Iterator[str]:
    """Yield the parameter files that packages ship for their own worlds, if one was made here."""
    for name, module in sorted(sys.modules.items()):
        for folder in [] if "." in name else getattr(module, "__path__", ()):
            file = Path(folder, "world.toml")
            makers = tomllib.loads(file.read_text(encoding="utf-8")).get("of", ()) if file.is_file() else ()
            if any(maker.partition(":")[0] in sys.modules for maker in makers):
                yield f"{name}:world.toml"


def _parameters(seen: _Names) -> Iterator[str]:
    first = next(iter(seen))
    makers = _shipped(first)["of"]
    yield f"of = {json.dumps(makers)}"
    for library, names in seen.items():
        shipped = _shipped(library)
        for table in shipped["parameter"]:
            found = names.get(table["name"], [])
            for name in found if len(found) <= _MOST else ["*"]:
                own = {"of": shipped["of"], **table}
                if name != "*":
                    own = {key: value for key, value in own.items() if key not in ("more", "less")}
                    own |= {"name": f"{table['name']} of {name}", "names": escape(name)}
                own["name"] += "" if library == first else f" in {library}"
                yield from ("", "[[world.parameter]]")
                kept = (pair for pair in own.items() if pair != ("of", makers))
                yield from (f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in kept)
