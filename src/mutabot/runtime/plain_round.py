"""A round outside of a campaign: plain pytest draws exactly the seeds of that round.

``MUTABOT_ROUND=3 pytest tests/test_place.py::test_it`` fails again where a campaign says that the test fails
in round 3. ``MUTABOT_CAMPAIGN_SEED`` is the campaign's seed, 1 if it is not set.
"""

from __future__ import annotations

import os
from collections.abc import Generator
from typing import Any

import pytest

from mutabot.model.call import CAMPAIGN_SEED_VARIABLE, DEFAULT_SEED, ROUND_VARIABLE, SEED_VARIABLE
from mutabot.runtime import seeds
from mutabot.runtime.seeds import node_id


class PlainRound:
    """Pytest's hooks for one round without a job.

    Args:
        seed: the campaign's seed.
        round: 0-based round.
    """

    def __init__(self, seed: int, round: int) -> None:
        self._seed, self._round = seed, round
        seeds.seed_all(seeds.derive(seed, "import"))

    @classmethod
    def from_environment(cls) -> PlainRound | None:
        """The round that the environment names, or None. Raises pytest.UsageError for what makes no sense."""
        number = _whole_number(ROUND_VARIABLE, least=1)
        if number is None:
            return None
        if os.environ.get(SEED_VARIABLE):
            text = f"{ROUND_VARIABLE} gives every test its seed in that round, {SEED_VARIABLE} another one"
            raise pytest.UsageError(f"{text}; set one of the two")
        seed = _whole_number(CAMPAIGN_SEED_VARIABLE, least=0)
        return cls(DEFAULT_SEED if seed is None else seed, number - 1)

    def seed_of(self, name: str) -> int:
        """The seed of a test or shared fixture in this round."""
        return seeds.derive(self._seed, self._round, name)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtestloop(self) -> Generator[None, Any, Any]:
        """All tests are collected."""
        seeds.seed_all(self.seed_of("session"))
        return (yield)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """One test, its fixtures included."""
        seeds.seed_all(self.seed_of(node_id(item)))
        return (yield)


def _whole_number(variable: str, *, least: int) -> int | None:
    text = os.environ.get(variable, "").strip()
    if not text:
        return None
    if not text.isdecimal() or int(text) < least:
        raise pytest.UsageError(f"{variable} is {text!r}; it takes a whole number from {least} on")
    return int(text)
