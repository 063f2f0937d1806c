"""How many mutants to draw, as a user writes it: ``20`` or ``10%``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from decimal import ROUND_HALF_UP, Decimal

from mutabot.errors import UsageError
from mutabot.frozen import frozen
from mutabot.limits import shortened

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
        """What ``10%``, ``12.5 %`` or ``50`` says. Raises UsageError for anything else."""
        plain = text.strip()
        share, count = _SHARE.fullmatch(plain), _COUNT.fullmatch(plain)
        if share is not None:
            percent = Decimal(share[1])
            if 0 < percent <= 100:
                return cls(plain, percent=percent)
            raise UsageError(f"a sample of {plain} cannot be drawn: a share is above 0 and at most 100 %")
        if count is not None:
            if int(plain) > 0:
                return cls(plain, count=int(plain))
            raise UsageError("a sample of 0 mutants says nothing: draw at least 1")
        raise UsageError(
            f"{shortened(text)!r} is no size of a sample; write a share such as 10% or a number such as 50"
        )

    def sizes(self, roles: Mapping[str, int]) -> dict[str, int]:
        """How many to draw of each role of one family, given how many there are.

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
            richest = max(sizes, key=lambda one: sizes[one])
            if sizes[richest] > 1:
                sizes[richest] -= 1
                sizes[role] += 1
        return sizes


def _rounded(number: Decimal) -> int:
    return int(number.quantize(Decimal(1), rounding=ROUND_HALF_UP))
