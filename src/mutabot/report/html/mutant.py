"""The data of one mutant's page."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from mutabot.analysis.divergence import change_text
from mutabot.analysis.results import MutantResult
from mutabot.border.codec import to_data
from mutabot.model import Looked, Outcome
from mutabot.model.seen.diverged import Diverged
from mutabot.report.shaping.status import rounds_text

#: what the page takes for granted where nothing is said
_NOTHING: tuple[Any, ...] = (None, (), [], "")
#: checks of a test that are shown; the journal has more
_CHECKS = 40


def mutant_page(result: MutantResult) -> dict[str, Any]:
    """All but what was recorded."""
    mutant = result.mutant
    interval = result.kill_rate.interval
    quantity = result.quantity
    change = next(filter(None, (change_text(mutant, one, quantity) for one in result.outcomes)), None)
    return {
        "number": mutant.number,
        "id": mutant.id,
        "places": [{"place": mutant.site.place, "function": mutant.site.span.function}],
        "pattern": mutant.pattern_name,
        "meaning": _meaning(result),
        "interval": [interval.low, interval.high] if interval is not None else None,
        "roundsText": rounds_text(result),
        "change": change,
        "rounds": [_round(one) for one in result.rounds],
        "looked": _looked(result),
    }


def _meaning(result: MutantResult) -> list[str]:
    quantity = result.quantity
    if quantity is None:
        return []
    words = (
        quantity.kind.value,
        quantity.axis and f"axis {quantity.axis}",
        quantity.unit and f"in {quantity.unit}",
        quantity.mode and f"{quantity.mode.value} an amount" if quantity.mode == "by" else None,
        quantity.frame and f"frame {quantity.frame}",
    )
    return [word for word in words if word]


def _round(outcome: Outcome | None) -> dict[str, Any] | None:
    if outcome is None:
        return None
    known = {
        "test": outcome.test,
        "exception": outcome.exception,
        "message": outcome.message,
        "place": outcome.place,
        "hits": outcome.hits,
        "acted": outcome.acted,
        "away": [[why, count] for why, count in outcome.away.items()],
        "example": [_value(one) for one in outcome.example] if outcome.example is not None else None,
        "tests": outcome.tests,
        "wall": outcome.wall,
        "simulated": outcome.simulated,
        "divergence": outcome.divergence,
        "gaps": outcome.gaps,
        "compared": outcome.compared.text if outcome.compared is not None else None,
        "indistinguishable": outcome.indistinguishable,
        "engine": outcome.engine,
        "repeats": outcome.repeats,
        "stuck": outcome.stuck,
        "beside": outcome.beside,
        "kills": [[one.test, one.by.value, one.message] for one in outcome.kills[1:]],
        "diverged": [_diverged(one) for one in outcome.diverged],
    }
    return {name: value for name, value in known.items() if value not in _NOTHING}


def _diverged(diverged: Diverged) -> Any:
    data = to_data(diverged)
    return {name: value for name, value in data.items() if value not in _NOTHING}


def _looked(result: MutantResult) -> dict[str, Any] | None:
    """The first round that it survived: who ran it, what they checked, and by how much that held."""
    for number, outcome in enumerate(result.rounds):
        if outcome is not None and outcome.looked:
            return {"round": number, "tests": [_test(one) for one in _by_use(outcome.looked)]}
    return None


def _by_use(looked: Iterable[Looked]) -> list[Looked]:
    """Those in which the mutant did anything first."""
    return sorted(looked, key=lambda one: not one.acted)


def _test(looked: Looked) -> dict[str, Any]:
    more = looked.more + max(0, len(looked.checks) - _CHECKS)
    return {
        "test": looked.test,
        "acted": looked.acted,
        "more": more,
        "checks": [[one.place, one.text, one.seen, one.spare, one.times] for one in looked.checks[:_CHECKS]],
    }


def _value(value: Any) -> Any:
    return value if value is None or isinstance(value, bool | int | float | str) else repr(value)
