"""What an operator at work knows beside the values: its subject, the calls of the test, and chance."""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random
from typing import Any

from mutabot.model import Call, Quantity

from .operator import Subject

_BITS = 64


class Draws:
    """Numbers drawn for one call, whatever other calls draw.

    A draw is keyed by the mutant's own seed, in which are campaign, round, test and site, and by the number
    of the call. From a stream a program that reads once more would shift all later draws, and one magnitude
    of a fault could not be compared with another (common random numbers: L'Ecuyer 1994; keyed generators:
    Salmon et al. 2011).

    Args:
        random: the mutant's generator for this round and test; one number is taken of it, now.
    """

    def __init__(self, random: Random) -> None:
        self._key = random.getrandbits(_BITS)

    def of(self, number: int) -> Random:
        """The generator of the call of this number, from 1; a new one each time."""
        return Random(f"{self._key}:{number}")


@dataclass(slots=True)
class Context:
    """One mutant at work in one test.

    Attributes:
        subject: what it acts on.
        random: its generator for this round and test; ``draw`` is the one of a call.
        option: what the operator's table of variants says of the subject's; None if that has none.
        call: the call of the value that it is about to change, for operators on values.
        number: of the call, from 1.
        memory: what the operator keeps from one call for later ones.
    """

    subject: Subject
    random: Random
    option: Any = None
    call: Call = field(init=False)
    number: int = 0
    memory: list[Any] = field(default_factory=list)
    _draws: Draws | None = None

    @property
    def quantity(self) -> Quantity:
        """The subject's quantity, for operators on values."""
        return quantity_of(self.subject)

    def draw(self) -> Random:
        """The call's own generator; a new one each time."""
        self._draws = self._draws or Draws(self.random)
        return self._draws.of(self.number)

    def by_chance(self) -> None:
        """Raises Unchanged unless chance wants this call; the option is how likely that is."""
        if self.draw().random() >= self.option:
            raise Unchanged("chance spares it")


def quantity_of(subject: Subject) -> Quantity:
    """The subject's quantity; an operator on values never gets a subject without one."""
    assert subject.quantity is not None
    return subject.quantity


class Unchanged(Exception):  # noqa: N818  # no error: a reason
    """Why an operator leaves a call, or what it reads, as it is."""
