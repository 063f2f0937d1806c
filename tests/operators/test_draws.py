"""Common random numbers: a hit draws the same whatever other hits drew."""

from __future__ import annotations

from random import Random

from mutabot.model import Operation
from mutabot.operators.operator import Context, Subject


def context(seed: int) -> Context:
    return Context(Subject(Operation("robot:Arm.home")), Random(seed))


def of(one: Context, number: int) -> Random:
    one.number = number
    return one.draw()


def test_a_hit_draws_the_same_however_much_the_hits_before_it_drew() -> None:
    one, other = context(7), context(7)
    for number in range(1, 6):
        first, second = of(one, number), of(other, number)
        assert first.random() == second.random()
        second.gauss(0.0, 1.0)


def test_hits_and_mutants_draw_differently() -> None:
    drawn = [of(one, n).random() for one in map(context, range(20)) for n in range(20)]
    assert len(set(drawn)) == len(drawn)
    assert 0.4 < sum(drawn) / len(drawn) < 0.6


def test_what_else_takes_numbers_of_the_same_generator_is_not_in_its_way() -> None:
    one = context(7)
    first = of(one, 1).random()
    one.random.random()
    assert of(one, 1).random() == first == of(context(7), 1).random()
