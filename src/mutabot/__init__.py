"""Mutation testing for robot programs: would your tests notice?

The names below are what plug-ins need, and ``open``, which reads the results of a campaign; all else is the
command line ``mutabot``. They are loaded when they are first used, so that ``import mutabot`` costs nothing
beside a robot program.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .lazy import lazily

if TYPE_CHECKING:
    from mutabot.results.stored import StoredCampaign as StoredCampaign
    from mutabot.results.stored import open as open

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
    "results.stored": ("StoredCampaign", "open"),
    "errors": ("MutabotError",),
    "model": ("Call", "Kind", "Middleware", "Mode", "Operation", "Pattern", "Proceed", "Quantity", "Reply"),
    "operators": ("Example", "Need", "Operator", "Subject"),
}
__getattr__, __dir__ = lazily(__name__, _HOMES)
