"""Values of command-line options about a campaign, parsed.

How long: ``90s``, ``10m``, ``1h30m``; how many mutants: ``20`` or ``10%``; which part of a campaign: ``2/8``;
which keys of the configuration have other values: ``rounds=5``.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from decimal import ROUND_HALF_UP, Decimal
from typing import Any

from mutabot.errors import UsageError, shortened
from mutabot.frozen import frozen

#: which operators' mutants are selected: of all that are asked for, or of those that are common among them
ALL, COMMON = "all", "common"
OPERATORS = (ALL, COMMON)
#: names of the engines, and of the choice between them
AUTO, FORK, REPLAY = "auto", "fork", "replay"
ENGINES = (FORK, REPLAY)
#: what a campaign can be asked to have none of
FAIL_ON = ("survivors", "untested")

# The greatest numbers that options and settings take: more cannot be meant, and cannot be done.
#: repetitions of a whole campaign: each has a baseline of its own
ROUNDS = 10_000
#: processes side by side: each takes a Python with pytest, some 50 MB
JOBS = 1_024
#: what every program that reads JSON can hold without loss
SEED = 2**53 - 1
#: runs of the original per round
BASELINES = 1_000
#: outcomes to look at again: all that there are
MOST_VERIFIED = 1_000_000_000
#: seconds, 11 days: what a system can wait for at once is no more than twice of it
SECONDS = 1_000_000
#: times the time of the original
FACTOR = 1_000_000
#: bytes, one petabyte
BYTES = 10**15
#: seconds that a campaign may take, 10,000 hours
BUDGET = 36_000_000

_PART = re.compile(r"(\d{1,12}(?:\.\d{1,12})?)\s*(h|min|m|s)")
_SECONDS = {"h": 3600.0, "min": 60.0, "m": 60.0, "s": 1.0}


def parse_duration(text: str) -> float:
    """Return the seconds in a text such as ``90s``, ``10m`` or ``1h 30m``. Raises UsageError otherwise."""
    plain, text = text.strip().lower(), shortened(text)
    parts = _PART.findall(plain)
    if not parts or _PART.sub("", plain).strip():
        raise UsageError(f"--budget {text}: no length of time; write 90s, 10m or 1h30m")
    found = sum(float(number) * _SECONDS[unit] for number, unit in parts)
    if found <= 0:
        raise UsageError(f"--budget {text}: nothing can be run in it; write 90s, 10m or 1h30m")
    if found > BUDGET:
        raise UsageError(f"--budget {text}: at most {BUDGET // 3600:,} hours can be meant")
    return found


def duration_text(seconds: float) -> str:
    """Return a duration as text: ``10 min``, ``1 h 30 min``, ``90 s``."""
    if seconds < 120 and seconds % 60:
        return f"{seconds:g} s"
    minutes, left = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    parts = [(hours, "h"), (minutes, "min"), (left, "s")]
    return " ".join(f"{number} {unit}" for number, unit in parts if number)


_SHARE = re.compile(r"([0-9]{1,9}(?:\.[0-9]{1,9})?)\s*%")
_COUNT = re.compile(r"[0-9]{1,9}")


@frozen
class Sample:
    """How many mutants to draw: a share of each family and role, or a number of each family.

    Attributes:
        text: as the user wrote it.
        percent: more than 0, at most 100; None if a number was given.
        count: at least 1; None if a share was given.
    """

    text: str
    percent: Decimal | None = None
    count: int | None = None

    @classmethod
    def parse(cls, text: str) -> Sample:
        """Parse ``10%``, ``12.5 %`` or ``50``. Raises UsageError for anything else."""
        plain = text.strip()
        share, count = _SHARE.fullmatch(plain), _COUNT.fullmatch(plain)
        if share is not None and 0 < Decimal(share[1]) <= 100:
            return cls(plain, percent=Decimal(share[1]))
        if count is not None and int(plain) > 0:
            return cls(plain, count=int(plain))
        raise UsageError(
            f"{shortened(text)!r} is not a sample size; write a share of at most 100 %, such as 10%, or a "
            "number such as 50"
        )

    def sizes(self, roles: Mapping[str, int]) -> dict[str, int]:
        """Return how many to draw of each role of one family, given how many there are.

        A number is divided as the mutants are; no role goes away empty while there is enough for all.
        """
        if self.percent is not None:
            return {role: max(1, _rounded(self.percent * count / 100)) for role, count in roles.items()}
        assert self.count is not None
        total = sum(roles.values())
        wanted = min(self.count, total)
        sizes = {role: wanted * count // total for role, count in roles.items()}
        by_remainder = sorted(roles, key=lambda role: wanted * roles[role] % total, reverse=True)
        for role in by_remainder[: wanted - sum(sizes.values())]:
            sizes[role] += 1
        for role in [role for role, size in sizes.items() if size == 0]:
            richest = max(sizes, key=lambda size: sizes[size])
            if sizes[richest] > 1:
                sizes[richest] -= 1
                sizes[role] += 1
        return sizes


def _rounded(number: Decimal) -> int:
    return int(number.quantize(Decimal(1), rounding=ROUND_HALF_UP))


_SHARD = re.compile(r"\s*([0-9]{1,6})\s*/\s*([0-9]{1,6})\s*")


@frozen
class Shard:
    """A numbered part of a campaign.

    Attributes:
        number: 1-based.
        of: how many there are.
    """

    number: int
    of: int

    @property
    def text(self) -> str:
        """``shard 2 of 8``."""
        return f"shard {self.number} of {self.of}"

    @classmethod
    def parse(cls, text: str) -> Shard:
        """Parse ``2/8``. Raises UsageError for anything else."""
        found = _SHARD.fullmatch(text)
        number, of = (int(found[1]), int(found[2])) if found is not None else (0, 0)
        if not 1 <= number <= of:
            raise UsageError(
                f"--shard {shortened(text)}: write its number, from 1, and how many there are, such as 2/8"
            )
        return cls(number, of)


#: parts of a key at most: a table and a key in it
_DEPTH = 2


def overridden(raw: dict[str, Any], texts: Sequence[str], lists: Collection[str]) -> dict[str, Any]:
    """Return a table of the configuration in which ``KEY=VALUE`` texts replace keys.

    A value is written as in TOML; what is no TOML is a text, so ``-o when=once`` needs no quotation marks. A
    text for one of the keys in ``lists`` (``TABLE.KEY`` in a table) is a list of one.

    Raises UsageError for a text that is not of this form.
    """
    found = dict(raw) if texts else raw
    for text in texts:
        key, sign, value = text.partition("=")
        parts = [part.strip() for part in key.split(".")]
        if not sign or not all(parts) or len(parts) > _DEPTH:
            raise UsageError(f"-o {text}: write KEY=VALUE, such as -o rounds=5 or -o cluster.ca=ca.pem")
        table, last = found, parts[-1]
        if len(parts) == _DEPTH:
            inner = found.get(parts[0])
            found[parts[0]] = table = dict(inner) if isinstance(inner, dict) else {}
        given = _value(value.strip())
        table[last] = [given] if ".".join(parts) in lists and isinstance(given, str) else given
    return found


def _value(text: str) -> Any:
    import tomllib  # noqa: PLC0415  # looking at results needs none

    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        return text
