"""Mutation testing for robot programs: would your tests notice?

``open`` reads the results of a campaign; ``mutabot.api`` is for packages that extend mutabot; all else is the
command line ``mutabot``. Names are loaded when they are first used, so that ``import mutabot`` costs nothing
beside a robot program.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .lazy import lazily

if TYPE_CHECKING:
    from mutabot.results.stored import StoredCampaign as StoredCampaign
    from mutabot.results.stored import open as open

    from .errors import MutabotError as MutabotError

__version__ = "0.1.0"

_HOMES = {
    "mutabot.results.stored": ("StoredCampaign", "open"),
    "mutabot.errors": ("MutabotError",),
}
__getattr__ = lazily(__name__, _HOMES)
