"""The parameters that ``mutabot init`` proposes: by name, those of the models that the tests have made."""

from __future__ import annotations

import json
import sys
import tomllib
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from glob import escape
from pathlib import Path
from typing import Any

import wrapt

from .patching import wrap

#: parameters of each kind that are proposed by the names of things; of more things, all together
_MOST = 4
_SHIPPED = Path(__file__).with_name("mujoco.toml")


class WorldProposer:
    """Parameters of the simulated world."""

    def watch(self) -> Callable[[], Any]:
        """Note the names of things in each MuJoCo model that this process makes."""
        names: dict[str, list[str]] = {}

        def note(_: Any, model: Any) -> None:
            with suppress(Exception):  # looking at a model must not disturb the program
                for kind, found in _things(model):
                    known = names.setdefault(kind, [])
                    known += [name for name in found if name not in known]

        def begin(_: Any) -> None:
            for reference in tomllib.loads(_SHIPPED.read_text(encoding="utf-8"))["of"]:
                with suppress(LookupError):
                    wrap(reference, after=note)

        wrapt.register_post_import_hook(begin, "mujoco")
        return lambda: {"names": names, "files": [*_files_of_packages()] if names else []}

    def lines(self, seen: Sequence[Any]) -> list[str]:
        """The table ``world``: a file that a package ships for its world, or a parameter for each thing."""
        files = list(dict.fromkeys(name for one in seen for name in one["files"]))
        names: dict[str, list[str]] = {}
        for one in seen:
            for kind, found in one["names"].items():
                names.setdefault(kind, []).extend(name for name in found if name not in names.get(kind, ()))
        if not names:
            return []
        head = ["", "[world]  # `mutabot run --family world` disturbs the simulated world"]
        return [*head, f"parameters = {json.dumps(files)}"] if files else [*head, *_parameters(names)]


PROPOSER = WorldProposer()


def _things(model: Any) -> Iterator[tuple[str, list[str]]]:
    """Yield kinds of parameters, and the names of what has them in a model."""
    from .mujoco import names_of  # noqa: PLC0415  # of no use where there is no MuJoCo

    bodies, geoms, joints = names_of(model, "body"), names_of(model, "geom"), names_of(model, "joint")
    free = [int(model.jnt_bodyid[n]) for n in range(model.njnt) if int(model.jnt_type[n]) == 0]
    yield "mass", [bodies[n] for n in free]
    yield "friction", [geoms[n] for n in range(model.ngeom) if int(model.geom_bodyid[n]) in free]
    yield "gain", [*names_of(model, "actuator").values()]
    damped = [n for n in range(model.njnt) if float(model.dof_damping[model.jnt_dofadr[n]]) > 0.0]
    yield "damping", [joints[n] for n in damped if int(model.jnt_type[n]) in (2, 3)]
    yield "gravity", ["*"] if float(model.opt.gravity[2]) else []


def _files_of_packages() -> Iterator[str]:
    """Yield what packages ship as parameters of worlds of their own, if this process has made such ones."""
    for name, module in sorted(sys.modules.items()):
        for folder in [] if "." in name else getattr(module, "__path__", ()):
            file = Path(folder, "world.toml")
            makers = tomllib.loads(file.read_text(encoding="utf-8")).get("of", ()) if file.is_file() else ()
            if any(one.partition(":")[0] in sys.modules for one in makers):
                yield f"{name}:world.toml"


def _parameters(names: dict[str, list[str]]) -> Iterator[str]:
    shipped = tomllib.loads(_SHIPPED.read_text(encoding="utf-8"))
    yield f"of = {json.dumps(shipped['of'])}"
    for table in shipped["parameter"]:
        found = list(filter(None, names.get(table["name"], ())))
        for name in found if len(found) <= _MOST else ["*"]:
            own = {key: value for key, value in table.items() if name == "*" or key not in ("more", "less")}
            own |= {} if name == "*" else {"name": f"{table['name']} of {name}", "names": escape(name)}
            yield from ("", "[[world.parameter]]")
            yield from (f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in own.items())
