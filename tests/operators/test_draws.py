"""Common random numbers: a hit draws the same whatever other hits drew."""

from __future__ import annotations

from random import Random

from mutabot.model import Operation
from mutabot.operators.operator import Context, Subject


def context(seed: int) -> Context:
    return Context(Subject(Operation("robot:Arm.home")), Random(seed))


def of(context_of_hit: Context, number: int) -> Random:
    context_of_hit.number = number
    return context_of_hit.draw()


def test_a_hit_draws_the_same_however_much_the_hits_before_it_drew() -> None:
    left, right = context(7), context(7)
    for number in range(1, 6):
        first, second = of(left, number), of(right, number)
        assert first.random() == second.random()
        second.gauss(0.0, 1.0)


def test_hits_and_mutants_draw_differently() -> None:
    drawn = [
        of(context_of_mutant, n).random() for context_of_mutant in map(context, range(20)) for n in range(20)
    ]
    assert len(set(drawn)) == len(drawn)
    assert 0.4 < sum(drawn) / len(drawn) < 0.6


def test_what_else_takes_numbers_of_the_same_generator_is_not_in_its_way() -> None:
    context_of_hit = context(7)
    first = of(context_of_hit, 1).random()
    context_of_hit.random.random()
    assert of(context_of_hit, 1).random() == first == of(context(7), 1).random()
