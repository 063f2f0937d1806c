"""A campaign as it may leave the machine: every text can be written in any format, every path is relative."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from typing import Any, TypeVar

from mutabot.analysis.results import MutantResult
from mutabot.analysis.stored.campaign import StoredCampaign
from mutabot.journal.records import Reaching

from .texts import Cleaner, legible

T = TypeVar("T")

#: facts of a campaign that tell nothing of the machine and its folders
_META = (
    "mutabot",
    "python",
    "versions",
    "seed",
    "rounds",
    "engine",
    "families",
    "order",
    "started",
    "seconds",
)


def portable(campaign: StoredCampaign) -> StoredCampaign:
    """The same campaign, fit for any report."""
    results = campaign.results
    clean = Cleaner(results.meta.get("root"))
    return StoredCampaign(
        replace(
            results,
            meta=mapped({key: results.meta[key] for key in _META if key in results.meta}, clean),
            state=clean(results.state),
            mutants=tuple(_mutant(one, clean) for one in results.mutants),
            graded=tuple(_mutant(one, clean) for one in results.graded),
            left_out=mapped(results.left_out, legible),
            controls=mapped(results.controls, clean),
            flaky=mapped(results.flaky, clean),
            attempt=mapped(results.attempt, clean),
            tests=tuple(
                replace(one, test=replace(one.test, test=clean(one.test.test))) for one in results.tests
            ),
        ),
        # a mark of the byte order is no part of the first line
        sources={
            legible(file): legible(text.removeprefix("\ufeff")) for file, text in campaign.sources.items()
        },
        operators=mapped(campaign.operators, legible),
        reaching=Reaching(
            mapped(campaign.reaching.tests, clean),
            {legible(site): tests for site, tests in campaign.reaching.sites.items()},
        ),
    )


def mapped(value: T, change: Callable[[str], str]) -> T:
    """The same data with every text in it changed; keys of tables too."""
    made: Any = _mapped(value, change)
    result: T = made
    return result


def _mapped(value: Any, change: Callable[[str], str]) -> Any:
    if isinstance(value, Enum):
        return value
    if isinstance(value, str):
        return change(value)
    if isinstance(value, Mapping):
        return {change(str(key)): _mapped(item, change) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return type(value)(_mapped(item, change) for item in value)
    if is_dataclass(value) and not isinstance(value, type):
        return replace(
            value, **{one.name: _mapped(getattr(value, one.name), change) for one in fields(value)}
        )
    return value


def _mutant(result: MutantResult, clean: Cleaner) -> MutantResult:
    """Ids and what stands in the program stay as they are: they are the user's own text."""
    return replace(
        result,
        mutant=mapped(result.mutant, legible),
        rounds=tuple(
            replace(mapped(one, clean), mutant=legible(one.mutant)) if one is not None else None
            for one in result.rounds
        ),
        why=clean(result.why),
    )
