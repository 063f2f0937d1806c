"""Sets up the environment of one worker's nodes, so that workers do not interfere."""

from __future__ import annotations

from collections.abc import Sequence

from mutabot.api.values import Operation

from . import _domain, _master
from ._mentions import mentions
from .simulation.settings import configure


def prepare(root: str, home: str, operations: Sequence[Operation] | None) -> bool:
    """Set up what nodes will find in the environment; see ``mutabot.runtime.targets.target``.

    Raises ``_master.MasterError`` if there is to be a master and none comes up.
    """
    has_domain = mentions(root, "rclpy") if operations is None else _domain.is_wanted(operations)
    if has_domain:
        configure()
        _domain.take(home)
    has_master = _master.is_wanted(root, operations)
    if has_master:
        _master.start(home)
    return has_domain or has_master
