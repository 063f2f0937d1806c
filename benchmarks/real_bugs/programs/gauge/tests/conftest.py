"""Cells that are drawn from the round's seed."""

from mutabot_cell.fixtures import *  # noqa: F403
