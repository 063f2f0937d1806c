"""Describe in one line why a mutant ended as it did."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from mutabot.model import Mutant, Outcome, Quantity, Verdict, Vocabulary
from mutabot.model.outcome_text import first_line
from mutabot.model.quantity import distinct_texts, value_text

#: what is said of the world where nothing was compared
UNKNOWN_END = "it is unknown how the world ended (the vocabulary names no probe)"


def quantity_of(mutant: Mutant, vocabulary: Vocabulary | None) -> Quantity | None:
    """Return the quantity that a mutant changes; None if it changes none or the vocabulary is not known."""
    if vocabulary is None:
        return None
    return vocabulary.quantity(mutant.operation, mutant.pattern, mutant.quantity)


def explain(mutant: Mutant, outcomes: Sequence[Outcome], vocabulary: Vocabulary | None = None) -> str:
    """Describe a mutant's outcomes in a line: what changed, and its effect or who noticed.

    Speaks about the survivor farthest from the original, if there is any; else about a round in which no
    test reached it; else about the verdict that occurred most.
    """
    if not outcomes:
        return "not run"
    quantity = quantity_of(mutant, vocabulary)
    survivors = [outcome for outcome in outcomes if outcome.verdict is Verdict.SURVIVED]
    if survivors:
        worst = max(survivors, key=weight_of)
        return f"{change_text(mutant, worst, quantity) or mutant.description}; {_world_text(worst)}"
    verdict, _ = Counter(outcome.verdict for outcome in outcomes).most_common(1)[0]
    if any(outcome.verdict is Verdict.NOT_COVERED for outcome in outcomes):
        verdict = Verdict.NOT_COVERED
    return _end_text(next(outcome for outcome in outcomes if outcome.verdict is verdict))


def change_text(mutant: Mutant, outcome: Outcome, quantity: Quantity | None = None) -> str | None:
    """Return what the mutant changed when it first acted: ``read -0.0014 m instead of 0.0014 m``.

    That is in the test that has the story, if there is one.
    """
    reported = outcome.shown_difference.example if outcome.shown_difference is not None else None
    example = reported if reported is not None else outcome.example
    if mutant.quantity is None or example is None or len(example) != 2:
        return None
    text = quantity.text if quantity is not None else value_text
    before, after = distinct_texts(*example, text, 6 if quantity is not None else 4)
    if before == after:
        return None
    return f"{_verb(quantity)} {after} instead of {before}"


def weight_of(outcome: Outcome) -> tuple[bool, float]:
    """Rank a round for reports: one that differs in a stable test first, then the largest deviation."""
    shown = outcome.shown_difference
    return shown is not None and not shown.scatters, outcome.deviation or 0.0


def _verb(quantity: Quantity | None) -> str:
    if quantity is None:
        return "had"
    return "sent" if quantity.path.root is not None else "read"


def _world_text(outcome: Outcome) -> str:
    if outcome.indistinguishable:
        extent = f"in {outcome.compared.text}" if outcome.compared is not None else "that was compared"
        return f"nothing differs {extent} (indistinguishable)"
    story = outcome.shown_difference.story if outcome.shown_difference is not None else ""
    if story:
        return story
    if outcome.divergence:
        return outcome.divergence[0]
    if outcome.gaps:
        return f"not compared with the original: {outcome.gaps[0]}"
    if outcome.distance is not None:
        return "every probe ended within its tolerance"
    return UNKNOWN_END


def _end_text(outcome: Outcome) -> str:
    match outcome.verdict:
        case Verdict.NOT_COVERED:
            return "no test reaches it"
        case Verdict.NO_EFFECT:
            return outcome.message or "it changed no value"
        case Verdict.KILLED:
            return f"killed by {outcome.by or 'a test'}: {first_line(outcome.message)}"
        case _:
            return f"{outcome.verdict}: {first_line(outcome.message)}"
