"""Makes runs on workers equivalent to those here: versions, variables, module folders."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

#: variables that say how Python, pytest and numbers behave, each by its whole name: a prefix would also take
#: what others keep under such a name, as a key. Those that name places stay with their machine.
_DECIDED = {
    "LANG", "LANGUAGE", "LC_ALL", "LC_ADDRESS", "LC_COLLATE", "LC_CTYPE", "LC_IDENTIFICATION",
    "LC_MEASUREMENT", "LC_MESSAGES", "LC_MONETARY", "LC_NAME", "LC_NUMERIC", "LC_PAPER", "LC_TELEPHONE",
    "LC_TIME", "TZ",
    "PYTHONASYNCIODEBUG", "PYTHONBREAKPOINT", "PYTHONCOERCECLOCALE", "PYTHONDEBUG", "PYTHONDEVMODE",
    "PYTHONDONTWRITEBYTECODE", "PYTHONFAULTHANDLER", "PYTHONHASHSEED", "PYTHONINTMAXSTRDIGITS",
    "PYTHONIOENCODING", "PYTHONMALLOC", "PYTHONNODEBUGRANGES", "PYTHONNOUSERSITE", "PYTHONOPTIMIZE",
    "PYTHONSAFEPATH", "PYTHONTRACEMALLOC", "PYTHONUNBUFFERED", "PYTHONUTF8", "PYTHONWARNDEFAULTENCODING",
    "PYTHONWARNINGS", "PYTHON_COLORS", "PYTHON_CPU_COUNT", "PYTHON_FROZEN_MODULES", "PYTHON_GIL",
    "PYTHON_JIT", "PYTHON_CONTEXT_AWARE_WARNINGS", "PYTHON_THREAD_INHERIT_CONTEXT",
    "PYTEST_ADDOPTS", "PYTEST_DISABLE_PLUGIN_AUTOLOAD", "PYTEST_PLUGINS",
    "BLIS_NUM_THREADS", "GOTO_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS", "NUMEXPR_NUM_THREADS",
    "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS",
    "MUJOCO_GL", "PYOPENGL_PLATFORM",
}  # fmt: skip
#: of these, what a worker or its nanny has set is taken away: mutabot's processes then get what they get here
_RESET = (
    "PYTHONHASHSEED", "PYTHONOPTIMIZE", "PYTHONWARNINGS", "PYTEST_ADDOPTS", "PYTEST_PLUGINS", "TZ",
    "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS",
)  # fmt: skip


def decided() -> dict[str, str | None]:
    """Return the variables that this machine sets for all workers; None for those to be unset."""
    return dict.fromkeys(_RESET) | {name: text for name, text in os.environ.items() if name in _DECIDED}


def apply(environment: Mapping[str, str | None], paths: Iterable[str]) -> None:
    """Set these variables for new processes, and let them find modules in these folders first."""
    for name, value in environment.items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value
    own = os.environ.get(_OWN_PATH)
    if own is None:
        own = os.environ[_OWN_PATH] = os.environ.get("PYTHONPATH", "")
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [*paths, own]))


#: the PYTHONPATH that a worker began with
_OWN_PATH = "MUTABOT_WORKERS_PYTHONPATH"


def module_folders(root: Path) -> tuple[str, ...]:
    """Return the project's folders from which modules are imported, relative to it.

    Installed in place, a project would be imported from where it was installed, not from its copy.
    """
    found: dict[str, None] = {}
    for folder in _search_path(root):
        if folder == root or root in folder.parents:
            inside = folder.relative_to(root)
            if not any(part.startswith(".") for part in inside.parts):  # as of a virtual environment
                found[inside.as_posix()] = None
    return tuple(found)


def _search_path(root: Path) -> Iterator[Path]:
    for entry in filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep)):
        yield (root / entry).resolve()
    for entry in sys.path:
        if entry and "site-packages" not in entry:
            yield Path(entry).resolve()
    for finder in list(sys.modules.values()):  # how setuptools installs in place where a path would not do
        mapping = getattr(finder, "MAPPING", None)
        if getattr(finder, "__name__", "").startswith("__editable__") and isinstance(mapping, dict):
            yield from (Path(place).resolve().parent for place in mapping.values())


def differences(here: Mapping[str, str], there: Mapping[str, str]) -> list[str]:
    """Describe the differences between two machines' versions."""
    found = []
    for name in sorted({*here, *there}, key=lambda name: (name not in _FIRST, name)):
        if here.get(name) != there.get(name):
            ours, theirs = (versions.get(name, "missing") for versions in (here, there))
            is_digest = "#" in (here.get(name, " ") + there.get(name, " "))
            found.append(f"{name} is another" if is_digest else f"{name} is {theirs} there, {ours} here")
    return found


_FIRST = ("python", "machine", "mutabot")
