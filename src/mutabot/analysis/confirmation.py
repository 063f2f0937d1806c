"""Confirmation: how many survivors the whole suite lets through, too, and how many others may be wrong.

Those that were run with the whole suite as well are the first ones in a random order, so a random sample. The
number that it would notice among the others has an exact upper limit from the hypergeometric distribution.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import takewhile

from mutabot.frozen import frozen
from mutabot.journal.records import LET_THROUGH, Repeated, is_wrong, run_short
from mutabot.model import Outcome, Verdict

from .chance import remaining
from .statistics import LEVEL


@frozen
class Confirmed:
    """What the whole suite says of mutants that were run without some of its tests.

    Attributes:
        outcomes: survivors, in all rounds, and what was refused while tests were left out.
        refused: how many of them were refused.
        confirmed: how many of them the whole suite lets through.
        wrong: how many more it noticed.
        left: how many were not run with it.
        most: how many of these it would notice at most; None if none was run with it.
        level: how often such a limit holds.
    """

    outcomes: int
    refused: int
    confirmed: int
    wrong: int
    left: int
    most: int | None
    level: float = LEVEL

    @classmethod
    def of(cls, outcomes: Iterable[Outcome], seed: int) -> Confirmed | None:
        """Of these outcomes; None if no test was left out."""
        outcomes = list(outcomes)
        drawn = run_short(outcomes, seed)
        if not drawn:
            return None
        left = sum(not one.confirmed for one in drawn)
        let_through = [one for one in drawn if one.verdict in LET_THROUGH]
        whole = sum(one.verdict is Verdict.SURVIVED and one.confirmed is None for one in outcomes)
        sample = list(takewhile(lambda one: one.confirmed, drawn))
        found = Repeated(len(drawn), len(sample), sum(map(is_wrong, sample)))
        most = min(remaining(found, 2 * LEVEL - 1)[1], left) if sample else None  # one end of its interval
        refused = sum(one.verdict is Verdict.REFUSED for one in let_through)
        all = whole + len(let_through)
        return cls(all, refused, all - left, sum(map(is_wrong, drawn)), left, most)

    @property
    def text(self) -> str:
        """``40 of 120 survivors confirmed by the whole suite, none was wrong: at most …``."""
        what = "survivors and refused mutants" if self.refused else "survivors"
        text = f"{self.confirmed} of {self.outcomes} {what} confirmed by the whole suite"
        if self.left and self.most is None:
            return f"{text}; how many of the others are wrong is not known"
        text += f", which notices {self.wrong} more" if self.wrong else ", none was wrong"
        if not self.left or self.most is None:
            return text
        share, level = math.ceil(100 * self.most / self.left), round(100 * self.level)
        return f"{text}: at most {share} % of the others, {level} %"
