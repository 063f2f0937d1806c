"""Where randomness starts: every (campaign seed, round, test) has a seed of its own."""

from __future__ import annotations

import hashlib

#: environment variables for tests that run without a campaign: the seed of every test alike; or the number of
#: a round, from 1 as they are printed, and the campaign's seed, which give every test its seed in that round
SEED_VARIABLE, ROUND_VARIABLE, CAMPAIGN_SEED_VARIABLE = (
    "MUTABOT_SEED", "MUTABOT_ROUND", "MUTABOT_CAMPAIGN_SEED",
)  # fmt: skip
#: the campaign's seed unless configuration or command line say otherwise
DEFAULT_SEED = 1


def derive(*parts: object) -> int:
    """A whole number of 32 bits that depends on all parts and on nothing else."""
    text = "\x1f".join(str(part) for part in parts)
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=4).digest(), "big")
