"""Replay: one fresh process per (mutant, round). Simple; it defines what is right, and takes every mutant."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from mutabot.campaign.baseline.taking import REPETITIONS
from mutabot.campaign.campaign import Campaign
from mutabot.campaign.engines.controls import run_controls
from mutabot.campaign.engines.engine import Engine, Remainder, Trial
from mutabot.campaign.engines.fresh import longest_first, replay
from mutabot.journal.records import ControlEnd
from mutabot.model import Mutant, Outcome


class Replay:
    """The engine; see ``Engine``."""

    name = "replay"
    order = 100
    runs = REPETITIONS
    may_share = False

    def run(self, campaign: Campaign, trials: list[Trial], left: Remainder) -> Iterator[Outcome | ControlEnd]:
        """Controls first, then each mutant by itself."""
        yield from run_controls(campaign, {mutant.id: mutant for mutant, _ in trials}.values())
        is_all = campaign.request.engine == self.name
        campaign.progress.stage("mutants" if is_all else "mutants by replay", len(trials))
        yield from replay(campaign, longest_first(campaign, trials))

    def try_controls(
        self, campaign: Campaign, mutants: Iterable[Mutant], left: Remainder
    ) -> Iterator[ControlEnd]:
        """One pair for each way into the program."""
        yield from run_controls(campaign, mutants)


ENGINE: Engine = Replay()
