"""The pytest plugin: sleeps unless a job is given, and always offers the fixture ``mutabot_seed``."""

from __future__ import annotations

import os

import pytest


@pytest.fixture
def mutabot_seed() -> int:
    """The seed of this test in this round: a whole number of 32 bits.

    Outside a campaign it comes from the environment variable MUTABOT_SEED, default 0.
    """
    return int(os.environ.get("MUTABOT_SEED", "0"))
