"""Answers that are the robot's own memory, and what a program writes to a copy of one."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mutabot.model import Kind, Path, Quantity
from mutabot.runtime.interception.live import HandedCopies, is_live

WHOLE = (Quantity("result", Path(), Kind.POSITION, "x", "m"),)
FIRST = (Quantity("[0]", Path.parse("[0]", rooted=False), Kind.POSITION, "x", "m"),)
INNER = (Quantity(".position[0]", Path.parse(".position[0]", rooted=False), Kind.POSITION, "x", "m"),)


class Robot:
    def __init__(self) -> None:
        self.numbers = [0.0, 0.0]
        self.array = np.zeros(3)
        self.state = SimpleNamespace(position=np.zeros(3))
        self.memory = bytearray(24)

    def its_view(self) -> Any:
        return self.array[:2]

    def its_memory(self) -> Any:
        return np.frombuffer(self.memory)

    def fresh_around_its_own(self) -> Any:
        return SimpleNamespace(position=self.array)


LIVE: dict[str, tuple[Callable[[Robot], Any], tuple[Quantity, ...]]] = {
    "a list": (lambda robot: robot.numbers, FIRST),
    "an array": (lambda robot: robot.array, FIRST),
    "a view": (Robot.its_view, FIRST),
    "memory": (Robot.its_memory, FIRST),
    "an object": (lambda robot: robot.state, INNER),
    "a part": (Robot.fresh_around_its_own, INNER),
    "in a tuple": (lambda robot: (robot.array, 1), FIRST),
}
FRESH: dict[str, tuple[Callable[[Robot], Any], tuple[Quantity, ...]]] = {
    "a list": (lambda robot: list(robot.numbers), FIRST),
    "an array": (lambda robot: robot.array + 1.0, FIRST),
    "a view of a new array": (lambda robot: (robot.array + 1.0)[:2], FIRST),
    "a view of its view": (lambda robot: (robot.array + 1.0)[:2][::-1], FIRST),
    "an object": (lambda robot: SimpleNamespace(position=robot.array + 1.0), INNER),
    "an object with a list": (lambda robot: SimpleNamespace(position=[0.5]), INNER),
    "a number": (lambda robot: 0.5, WHOLE),
    "a tuple": (lambda robot: (0.5, "left"), FIRST),
    "nothing": (lambda robot: None, WHOLE),
}


@pytest.mark.parametrize("name", LIVE)
def test_what_the_robot_keeps_is_live(name: str) -> None:
    robot, (read, quantities) = Robot(), LIVE[name]
    answer = read(robot)
    assert is_live(answer, quantities)


@pytest.mark.parametrize("name", FRESH)
def test_what_is_made_for_the_program_is_not(name: str) -> None:
    robot, (read, quantities) = Robot(), FRESH[name]
    answer = read(robot)
    assert not is_live(answer, quantities)


def test_a_write_to_a_copy_is_seen_also_if_the_program_has_dropped_it() -> None:
    robot, copies = Robot(), HandedCopies()
    copies.note(robot.array, np.ones(3), FIRST)
    assert not copies.look()
    handed = np.ones(3)
    copies.note(robot.array, handed, FIRST)
    handed[0] = 0.25
    del handed
    assert copies.look()


def test_a_write_to_an_alias_is_seen_however_late() -> None:
    robot, copies = Robot(), HandedCopies()
    alias = [1.0, 2.0]
    copies.note(robot.numbers, alias, FIRST)
    for _ in range(3):
        assert not copies.look()
        copies.note(robot.numbers, [3.0, 4.0], FIRST)
    alias[1] = 0.0
    assert copies.look()


def test_of_many_that_the_program_keeps_the_last_are_looked_at_and_in_the_end_all() -> None:
    robot, copies = Robot(), HandedCopies()
    log = [[float(number)] for number in range(100)]
    for entry in log:
        copies.note(robot.numbers, entry, FIRST)
    log[3][0] = -1.0
    assert not copies.look()
    assert copies.look(at_all=True)


def test_a_write_to_a_part_of_a_copy_is_seen() -> None:
    robot, copies = Robot(), HandedCopies()
    handed = SimpleNamespace(position=np.ones(3))
    copies.note(robot.state, handed, INNER)
    assert not copies.look()
    handed.position[2] = 0.5
    assert copies.look()


def test_a_part_that_is_no_copy_may_be_written_to() -> None:
    """The program gets the robot's own, so that nothing is lost."""
    copies, own = HandedCopies(), [0.0]
    copies.note(SimpleNamespace(x=0.0, more=own), SimpleNamespace(x=1.0, more=own), ())
    own[0] = 0.5
    assert not copies.look()


class Pose:
    def __init__(self) -> None:
        self.x = 0.5
        self._norm: float | None = None
        self.note: str | None = None

    @cached_property
    def doubled(self) -> float:
        return 2.0 * self.x

    @property
    def norm(self) -> float:
        if self._norm is None:
            self._norm = abs(self.x)
        return self._norm


def test_what_an_object_remembers_by_itself_is_no_write() -> None:
    copies, handed = HandedCopies(), Pose()
    copies.note(Pose(), handed, ())
    assert handed.doubled + handed.norm == 1.5
    assert not copies.look()


@pytest.mark.parametrize(("name", "value"), [("x", 0.25), ("note", "hot"), ("new", 1)])
def test_an_attribute_that_the_program_sets_is_one(name: str, value: Any) -> None:
    copies, handed = HandedCopies(), Pose()
    copies.note(Pose(), handed, ())
    setattr(handed, name, value)
    assert copies.look()


def test_copies_that_the_program_has_no_more_are_not_kept() -> None:
    robot, copies = Robot(), HandedCopies()
    for _ in range(100):
        copies.note(robot.array, np.ones(3), FIRST)
        copies.look()
    assert len(copies._handed) == 0
