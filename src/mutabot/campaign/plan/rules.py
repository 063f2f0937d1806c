"""All operators that there are, as the command line lists them: nothing of a project is asked for it."""

from __future__ import annotations

from collections.abc import Collection

from mutabot.campaign.faults.providers import rules_of
from mutabot.frozen import frozen
from mutabot.operators.operator import Rule, in_order
from mutabot.settings.families import known_families


@frozen
class ListedRule:
    """One operator.

    Attributes:
        name, family, summary: the operator's own.
        where: where it applies, in the words of vocabularies; empty if it does not say.
        source: the bug class that it stands for, or the published operators that it makes; else empty.
    """

    name: str
    family: str
    summary: str
    where: str
    source: str


def listed_rules(families: Collection[str] = ()) -> list[ListedRule]:
    """The operators of these families, or all: by family, in the order of the documentation.

    Raises OperatorError for a plug-in that is of no use.
    """
    wanted = [family for family in known_families() if not families or family in families]
    rules = rules_of(wanted)
    return [
        ListedRule(rule.name, rule.family, rule.summary, rule.where, _source(rule))
        for family in wanted
        for rule in in_order(rule for rule in rules if rule.family == family)
    ]


def _source(rule: Rule) -> str:
    if rule.stands_for or not rule.published:
        return rule.stands_for
    rows = "; ".join(f"{row.original} → {row.mutant}" for row in rule.published)
    return f"Published operators: {rows}."
