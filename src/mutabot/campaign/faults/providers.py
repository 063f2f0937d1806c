"""All providers of faults: the core's own, and those of packages."""

from __future__ import annotations

from collections.abc import Collection

from mutabot.errors import ExtensionError, unknown_name_text
from mutabot.families import OF_CALLS, ROBOT
from mutabot.faults import FaultProvider, Preparation, Project, brought_providers
from mutabot.operators.operator import Rule
from mutabot.operators.registry import names as operators_on_calls
from mutabot.operators.registry import operator as operator_on_calls

from .calls import CallFaults, MessageFaults

_OWN: tuple[FaultProvider, ...] = (CallFaults(), MessageFaults())


def all_providers() -> tuple[FaultProvider, ...]:
    """Every provider, in the order of their mutants' numbers."""
    return (*_OWN, *brought_providers())


def asked_for(project: Project) -> list[FaultProvider]:
    """The providers of which mutants are asked for. Those of packages are looked for only if one may be."""
    known = _OWN if set(project.families) <= set(OF_CALLS) else all_providers()
    return [provider for provider in known if provider.is_asked_for(project)]


def prepare(project: Project) -> dict[str, Preparation]:
    """What the providers need of the baseline, by their names."""
    found: dict[str, Preparation] = {}
    first = 1
    for provider in asked_for(project):
        found[provider.name] = prepared = provider.prepare(project, first)
        first += sum(len(text.places) for text in prepared.texts)
    return found


def provider(name: str) -> FaultProvider:
    """The provider of this name. Raises ExtensionError if there is none."""
    own = {one.name: one for one in _OWN}
    known = own if name in own else {one.name: one for one in all_providers()}
    if name in known:
        return known[name]
    raise ExtensionError(unknown_name_text("provider of faults", name, known))


def family_of(mutant: str) -> str:
    """The family of the mutant with this id; that of calls where nobody knows its operator any more."""
    operator = mutant.rpartition(":")[2].partition("=")[0].partition("@")[0]
    if operator in operators_on_calls():
        return operator_on_calls(operator).family
    return operators_of_packages().get(operator, ROBOT)


def rules_of(families: Collection[str]) -> list[Rule]:
    """The operators of the providers of these families; of other packages nothing is loaded."""
    known = _OWN if set(families) <= set(OF_CALLS) else all_providers()
    brought = [one for one in known if one not in _OWN and not set(one.families).isdisjoint(families)]
    return [rule for one in (*_OWN, *brought) for rule in one.rules()]


def operators_of_packages() -> dict[str, str]:
    """The operators of the packages' providers, with their families. To look at these may take its time."""
    return {rule.name: rule.family for one in brought_providers() for rule in one.rules()}
