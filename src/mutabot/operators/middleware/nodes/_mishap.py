"""Operators that let one thing befall a call."""

from __future__ import annotations

from random import Random
from typing import ClassVar

from mutabot.model import Call, Middleware, Mishap, Proceed, Reply
from mutabot.operators.middleware._forms import FormOperator
from mutabot.operators.operator import Subject

_ONCE = "it has happened already"


class MishapOperator(FormOperator):
    """Lets a mishap befall a call, wherever it can.

    Class attributes:
        mishap: what befalls it.
        once: whether only the first call of a test.
    """

    is_for_oracle = False
    mishap: ClassVar[Mishap]
    once: ClassVar[bool] = False

    def seconds(self, subject: Subject) -> float:
        """Seconds that the mishap takes."""
        return 0.0

    def middleware(self, subject: Subject, random: Random) -> Middleware:
        is_over = False

        async def mutated(call: Call, proceed: Proceed) -> Reply:
            nonlocal is_over
            why = call.cannot(self.mishap) or (_ONCE if is_over else "")
            if why:
                return await proceed(call.as_is(why))
            is_over = self.once
            return await proceed(call.with_mishap(self.mishap, self.seconds(subject)))

        return mutated
