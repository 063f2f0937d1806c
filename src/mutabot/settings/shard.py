"""Which part of a campaign to run, as a user writes it: ``2/8``."""

from __future__ import annotations

import re

from mutabot.errors import UsageError
from mutabot.frozen import frozen
from mutabot.limits import shortened

_SHARD = re.compile(r"\s*([0-9]{1,6})\s*/\s*([0-9]{1,6})\s*")


@frozen
class Shard:
    """One of so many parts of a campaign.

    Attributes:
        number: 1-based.
        of: how many there are.
    """

    number: int
    of: int

    @property
    def words(self) -> str:
        """``shard 2 of 8``."""
        return f"shard {self.number} of {self.of}"

    @classmethod
    def parse(cls, text: str) -> Shard:
        """What ``2/8`` says. Raises UsageError for anything else."""
        found = _SHARD.fullmatch(text)
        if found is None:
            raise UsageError(
                f"--shard {shortened(text)}: write its number and how many there are, such as 2/8"
            )
        number, of = int(found[1]), int(found[2])
        if of < 1:
            raise UsageError(f"--shard {text}: there must be at least one shard, 1/1")
        if not 1 <= number <= of:
            raise UsageError(f"--shard {text}: shards of {of} are numbered 1/{of} to {of}/{of}")
        return cls(number, of)
