"""Names of a module that are loaded when they are first used (PEP 562)."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module


def lazily(module: str, homes: Mapping[str, tuple[str, ...]]) -> Callable[[str], object]:
    """Return the ``__getattr__`` of a module.

    There is no ``__dir__`` to go with it: libraries that walk through the attributes of all modules, as those
    do that replace clocks everywhere, would load in the processes of the tests all that only the controller
    needs.

    Args:
        module: the full name of the module.
        homes: the full names of the modules that define its names, with the names that each of them defines.
    """
    home_of = {name: home for home, names in homes.items() for name in names}
    own = vars(sys.modules[module])

    def load(name: str) -> object:
        if name not in home_of:
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        found = own[name] = getattr(import_module(home_of[name]), name)
        return found

    return load
