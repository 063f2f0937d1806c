"""The plan: the mutants of all providers that are asked for, in one order and with their numbers."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby

from mutabot.campaign.baseline.baseline import Baseline
from mutabot.campaign.faults.providers import asked_for
from mutabot.faults import Preparation, Project

from .planned import Plan


def make_plan(baseline: Baseline, project: Project) -> Plan:
    """All mutants that are asked for, provider by provider; the baseline learns of their places."""
    plan = Plan([], [])
    planned = {
        provider: provider.plan(project, baseline.prepared.get(provider.name, Preparation()), baseline)
        for provider in asked_for(project)
    }
    baseline.take_in({provider.name: found for provider, found in planned.items()})
    for _, together in groupby(planned, key=lambda one: one.numbered_with or one.name):
        found = sorted(
            (one for provider in together for one in planned[provider].mutants), key=lambda one: one.order
        )
        plan.left_out.extend(one.as_left_out for one in found if one.reason is not None)
        first = len(plan.mutants) + 1
        made = [one.mutant for one in found if one.reason is None]
        plan.mutants.extend(replace(one, number=number) for number, one in enumerate(made, start=first))
    return plan
