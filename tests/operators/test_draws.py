"""Common random numbers: a hit draws the same whatever other hits drew."""

from __future__ import annotations

from random import Random

from mutabot.operators.operator import Draws


def test_a_hit_draws_the_same_however_much_the_hits_before_it_drew() -> None:
    one, other = Draws(Random(7)), Draws(Random(7))
    for number in range(1, 6):
        first, second = one.of(number), other.of(number)
        assert first.random() == second.random()
        second.gauss(0.0, 1.0)


def test_hits_and_mutants_draw_differently() -> None:
    drawn = [draws.of(n).random() for draws in map(Draws, map(Random, range(20))) for n in range(20)]
    assert len(set(drawn)) == len(drawn)
    assert 0.4 < sum(drawn) / len(drawn) < 0.6


def test_what_else_takes_numbers_of_the_same_generator_is_not_in_its_way() -> None:
    random = Random(7)
    one = Draws(random)
    random.random()
    assert one.of(1).random() == Draws(Random(7)).of(1).random()
