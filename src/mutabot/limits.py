"""The greatest numbers that options and settings take: more cannot be meant, and cannot be done."""

from __future__ import annotations

#: repetitions of a whole campaign: each has a baseline of its own
ROUNDS = 10_000
#: processes side by side: each takes a Python with pytest, some 50 MB
JOBS = 1_024
#: what every program that reads JSON can hold without loss
SEED = 2**53 - 1
#: runs of the original per round
BASELINES = 1_000
#: outcomes to look at again: all that there are
VERIFIED = 1_000_000_000
#: seconds, 11 days: what a system can wait for at once is no more than twice of it
SECONDS = 1_000_000
#: times the time of the original
FACTOR = 1_000_000
#: bytes, one petabyte
BYTES = 10**15
#: seconds that a campaign may take, 10,000 hours
BUDGET = 36_000_000
#: whole numbers of TOML have 64 bits
LEAST_WHOLE, MOST_WHOLE = -(2**63), 2**63 - 1
#: lists in lists and tables in tables; entries of one list or table; bytes of a TOML file
DEPTH, ENTRIES, FILE_BYTES = 32, 10_000, 4_000_000
#: signs of a value that a message shows
SHOWN = 80


def shortened(text: str, most: int = SHOWN) -> str:
    """A text as a message shows it."""
    return text if len(text) <= most else f"{text[:most]}…"
