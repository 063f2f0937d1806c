"""Both robots at work, each with its own program."""

from __future__ import annotations

from giving import give
from station import Station
from taking import take

from mutabot_cell import run_together

WITHIN = 150.0
"""Longer than this nothing takes, s."""


def run(station: Station) -> dict[str, list[str]]:
    """Hand over all bars; returns what each robot reports, by its name."""
    programs = {"left": give(station), "right": take(station)}
    return run_together(station.cell, programs, within=WITHIN, seed=station.seed)
