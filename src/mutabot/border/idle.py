"""What a command answers while the robot does nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any

from mutabot.frozen import frozen
from mutabot.model.values.answer import is_plain

from .codec import from_data, to_data


@frozen
class Idle:
    """What a command answered at one place in the baseline, test by test.

    Attributes:
        answers: the different answers, as data that ``answer.restore`` understands.
        of_test: number of the answer that was the first in a test, by ``key``; tests that are missing here
            get the first of all.
        varying: keys of the tests in which later answers were others: there the answer tells something
            about the world, which stands still while the robot does nothing.
    """

    answers: tuple[Any, ...]
    of_test: Mapping[str, int] = field(default_factory=dict)
    varying: tuple[str, ...] = ()

    @staticmethod
    def key(round: int, test: str) -> str:
        """A test in a round, 0-based."""
        return f"{round} {test}"

    @classmethod
    def of(cls, data: Any) -> Idle:
        """The answers in a mutant's ``idle``; a plain value there is the only answer."""
        return cls((data,)) if is_plain(data) else from_data(cls, data)

    def data(self) -> Any:
        """The answers as a mutant carries them."""
        single = len(self.answers) == 1 and not self.varying and is_plain(self.answers[0])
        return self.answers[0] if single else to_data(self)

    def in_round(self, round: int) -> Any:
        """The answers as far as they count in a round."""
        here = {key: number for key, number in self.of_test.items() if key.startswith(f"{round} ")}
        used = sorted({0, *here.values()})
        return [
            [self.answers[number] for number in used],
            {key: used.index(number) for key, number in here.items()},
            [key for key in self.varying if key in here],
        ]

    def first(self, round: int, test: str) -> Any:
        """The data of the first answer in a test."""
        return self.answers[self.of_test.get(self.key(round, test), 0)]

    def is_varying(self, round: int, test: str) -> bool:
        """Whether answers differed in a test; in an unknown one, whether they did anywhere."""
        key = self.key(round, test)
        return key in self.varying if key in self.of_test else bool(self.varying)
