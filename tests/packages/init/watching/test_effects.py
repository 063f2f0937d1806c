"""Which functions only compute, by their text."""

from __future__ import annotations

import enum
import functools
import math
import os
import random
import re
import socket
import struct
import time
from typing import Any

import numpy as np
import pytest

from mutabot_init.watching.effects import only_computes


class Robot:
    def __init__(self, line: socket.socket) -> None:
        self.line, self.joints, self.angle = line, [self], 0.0

    @classmethod
    def at(cls, line: socket.socket) -> Robot:
        return cls(line)

    def forward(self, q: list[float]) -> list[float]:
        return [math.sin(angle) for angle in self._turned(q)]

    def _turned(self, q: list[float]) -> list[float]:
        found = []
        for angle in q:
            found.append(-angle)  # noqa: PERF401  # the text is the test
        return found

    def where(self) -> float:
        return self.angle

    def ask(self, text: str) -> Any:
        return self.line.send(text.encode())

    def move(self, x: float) -> Any:
        return self.ask(f"MOVE {x}")

    def alias(self, x: float) -> float:
        line = self.line
        line.send(b"%d" % x)
        return x

    def each(self, q: list[float]) -> list[Any]:
        return [joint.move(angle) for joint, angle in zip(self.joints, q, strict=True)]

    def turn(self, angle: float) -> float:
        self.angle = angle
        return self.angle

    def wait(self, seconds: float) -> float:
        time.sleep(seconds)
        return seconds

    def stands_in(self, x: float) -> Any:
        return self.angle

    def agrees(self, x: float) -> bool:
        return True

    async def later(self, x: float) -> float:
        return x


def fill(target: list[float], value: float) -> list[float]:
    target[0] = value
    return target


def table(values: list[float]) -> Any:
    found = np.zeros((len(values), 2))
    for index, value in enumerate(values):
        found[index] = value
    found = np.array(found).T
    return found.copy()


def fetched(client: Any, name: str) -> Any:
    return client.session.request(name)


def filled(value: float) -> list[float]:
    target = [0.0]
    target[0] = value
    return target


def checked(value: float) -> float:
    _refuse_nonsense(value)
    return -value


def _refuse_nonsense(value: float) -> None:
    if value < 0:
        raise ValueError(value)


def packed(value: int) -> bytes:
    return struct.pack("<H", value)


def numbered(value: int) -> bytes:
    return struct.pack("<HH", random.randint(0, 9), value)


def started(robots: list[Any]) -> Any:
    robot = random.choice(robots)
    return robot.start()


def shuffled(values: list[int]) -> list[int]:
    random.shuffle(values)
    return values


def commanded(value: float) -> float:
    _stub(value)
    return -value


def _stub(value: float) -> None:
    """Any robot may be behind this."""


def shown(value: float) -> float:
    print(value)
    return value


def factorial(value: int) -> int:
    return 1 if value < 2 else value * factorial(value - 1)


def remove(name: str) -> Any:
    return os.rmdir(name)  # noqa: PTH106  # as above


@functools.lru_cache
def parsed(text: str) -> tuple[str, int]:
    found = ADDRESS.fullmatch(text.strip())
    return ("", 0) if found is None else (found.group(1), int(found.group(2)))


def translated(text: str) -> bytes:
    name, number = parsed(text)
    return KINDS.get(name, name).encode() + number.to_bytes(2, "big")


def collected(text: str) -> int:
    SEEN.append(text)
    return len(text)


class Pin(enum.IntEnum):
    LAMP = 3

    def on(self) -> bool:
        return bool(os.write(self, b"1"))


def lit() -> bool:
    return LAMP.on()


KINDS, SEEN, LAMP = {"D": "W"}, ["D1"], Pin.LAMP
ADDRESS = re.compile(r"([DM])([0-9]+)")


@pytest.mark.parametrize(
    ("function", "expected"),
    [
        (translated, True), (collected, False), (lit, False),
        (Robot.__dict__["at"], True), (Robot.forward, True), (Robot.where, True), (filled, True),
        (table, True), (fetched, False), (checked, True), (packed, True),
        (commanded, False), (_refuse_nonsense, False),
        (factorial, True), (Robot.ask, False), (Robot.move, False), (Robot.alias, False),
        (Robot.each, False), (Robot.turn, False), (Robot.wait, False), (Robot.stands_in, False),
        (Robot.agrees, False), (Robot.later, False), (fill, False), (shown, False), (remove, False),
        (math.sin, False), (None, False), (numbered, True), (started, False), (shuffled, False),
    ],
)  # fmt: skip
def test_only_functions_whose_text_shows_it_compute(function: Any, expected: bool) -> None:
    owner = (
        Robot if "Robot." in getattr(getattr(function, "__func__", function), "__qualname__", "") else None
    )
    assert only_computes(function, owner) is expected
