"""The contract of whatever suggests a check that would have caught a survivor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mutabot.analysis.results import MutantResult
from mutabot.analysis.suggested import Suggestions
from mutabot.report.suggested.text import lines_of


@dataclass(frozen=True, slots=True)
class SuggestedCheck:
    """A check that would catch a mutant.

    Attributes:
        code: the lines to add to the tests.
        test: node id of the test that they belong to; empty if they are a test of their own.
        notes: what is known of it, a sentence each: what it was tried on, what else it kills.
    """

    code: str
    test: str = ""
    notes: tuple[str, ...] = ()


#: the check for a mutant; None if there is none
Suggest = Callable[[MutantResult], SuggestedCheck | None]


def suggest_from(found: Suggestions | None) -> Suggest | None:
    """What knows the checks that ``mutabot suggest`` found; None if it was not asked."""
    if found is None:
        return None

    def suggest(result: MutantResult) -> SuggestedCheck | None:
        for one in found.suggestions:
            if result.mutant.id in one.kills:
                statement, *notes = lines_of(one, found)
                return SuggestedCheck(statement, one.test, tuple(notes))
        return None

    return suggest
