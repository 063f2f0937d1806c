"""How many survivors the whole suite has confirmed, and the limit for the others."""

from __future__ import annotations

from math import comb
from random import Random

import pytest

from mutabot.journal.records import run_short
from mutabot.model import Outcome, Verdict
from mutabot.results.statistics import Confirmed

KILLED, SURVIVED, REFUSED = Verdict.KILLED, Verdict.SURVIVED, Verdict.REFUSED


def some(count: int, confirmed: int, seed: int = 1) -> list[Outcome]:
    """Survivors, of which the first ones that are drawn are confirmed."""
    drawn = run_short((Outcome(f"m{n}", 0, SURVIVED, confirmed=False) for n in range(count)), seed)
    return [Outcome(outcome.mutant, 0, SURVIVED, confirmed=n < confirmed) for n, outcome in enumerate(drawn)]


def test_nothing_is_said_where_no_test_was_left_out() -> None:
    assert Confirmed.of([Outcome("a", 0, SURVIVED), Outcome("b", 0, KILLED)], 1) is None


def test_the_limit_is_that_of_the_hypergeometric_distribution() -> None:
    found = Confirmed.of(some(120, 40), 1)
    assert found is not None
    likely = [wrong for wrong in range(81) if comb(120 - wrong, 40) / comb(120, 40) > 0.05]
    assert found.most == max(likely)
    assert found.text == (
        "40 of 120 survivors confirmed by the whole suite, none was wrong: at most 9 % of the others, 95 %"
    )


def test_among_many_others_the_limit_is_the_usual_one() -> None:
    found = Confirmed.of(some(20_040, 40), 1)
    assert found is not None
    assert found.most is not None
    assert found.most / found.left == pytest.approx(1 - 0.05 ** (1 / 40), abs=0.001)


def test_the_limit_holds_as_often_as_it_says() -> None:
    """Of mutants of which some are wrong; as soon as one is found all are run, so only other draws count."""
    random, held = Random(7), 0
    for _ in range(400):
        wrong = set(random.sample(range(60), 8))
        if not wrong.isdisjoint(range(20)):
            held += 1
            continue
        found = Confirmed.of(some(60, 20), 1)
        assert found is not None
        assert found.most is not None
        held += len(wrong) <= found.most
    assert held >= 0.95 * 400 - 9  # two standard deviations


def test_only_what_was_confirmed_without_a_gap_is_a_sample() -> None:
    """A shard that has confirmed more than others, or a campaign before an edit, has not drawn from all."""
    outcomes = some(120, 40)
    whole = Confirmed.of(outcomes, 1)
    outcomes[10] = Outcome(outcomes[10].mutant, 0, SURVIVED, confirmed=False)
    gap, ten = Confirmed.of(outcomes, 1), Confirmed.of(some(120, 10), 1)
    assert whole is not None and gap is not None and ten is not None  # noqa: PT018  # for the types
    assert (gap.confirmed, gap.most) == (39, ten.most)
    assert gap.most is not None and whole.most is not None  # noqa: PT018
    assert gap.most > whole.most


def test_what_was_noticed_and_what_was_refused_is_reported() -> None:
    outcomes = [
        *some(10, 10),
        Outcome("noticed", 0, KILLED, confirmed=True),
        Outcome("broken", 0, Verdict.ERROR, confirmed=True),  # says nothing
        Outcome("whole", 0, SURVIVED),
        Outcome("killed", 0, KILLED),
    ]
    found = Confirmed.of(outcomes, 1)
    assert found is not None
    assert found.text == "11 of 11 survivors confirmed by the whole suite, which notices 1 more"
    found = Confirmed.of([*outcomes, Outcome("refused", 0, REFUSED, confirmed=True)], 1)
    assert found is not None
    assert found.text.startswith("12 of 12 survivors and refused mutants confirmed")


def test_without_a_sample_nothing_is_known_of_the_others() -> None:
    found = Confirmed.of(some(5, 0), 1)
    assert found is not None
    assert found.text == (
        "0 of 5 survivors confirmed by the whole suite; how many of the others are wrong is not known"
    )
