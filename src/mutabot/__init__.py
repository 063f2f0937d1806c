"""Mutation testing for robot programs: would your tests notice?

The names below are what plug-ins need, and ``open``, which reads the results of a campaign; all else is the
command line ``mutabot``. They are loaded when they are first used, so that ``import mutabot`` costs nothing
beside a robot program.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mutabot.analysis.stored import StoredCampaign as StoredCampaign
    from mutabot.analysis.stored import open as open

    from .errors import MutabotError as MutabotError
    from .model import Call as Call
    from .model import Kind as Kind
    from .model import Middleware as Middleware
    from .model import Mode as Mode
    from .model import Operation as Operation
    from .model import Pattern as Pattern
    from .model import Proceed as Proceed
    from .model import Quantity as Quantity
    from .model import Reply as Reply
    from .operators import Example as Example
    from .operators import Need as Need
    from .operators import Operator as Operator
    from .operators import Subject as Subject

__version__ = "0.1.0"

_HOMES = {
    "analysis.stored": ("StoredCampaign", "open"),
    "errors": ("MutabotError",),
    "model": ("Call", "Kind", "Middleware", "Mode", "Operation", "Pattern", "Proceed", "Quantity", "Reply"),
    "operators": ("Example", "Need", "Operator", "Subject"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> object:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME_OF[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME_OF])
