"""``mutabot minimal``: runs a campaign with every test on every mutant, and shows a minimal set of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import typer

from mutabot.api.processes import Request
from mutabot.api.reports import CampaignRun, CommandContext

from .minimal import minimal_of, section
from .table import COLUMNS, aligned, described, remarks, rows, title

#: mutants that are listed without --all
_LISTED = 10

_Everything = Annotated[bool, typer.Option("--all", help="List the whole set.")]


def minimal(
    context: CommandContext, request: Request, everything: _Everything = False, json: bool = False
) -> None:
    """Run every test on every mutant, also after one has noticed it, and show a minimal set of the mutants.

    Killed mutants are left out that another one subsumes: whatever kills that one kills them too.
    Survivors are left out that make the same change as another. Takes longer than `run`, which
    stops at the first test.
    """
    with context.progress() as progress:
        CampaignRun.to_end(replace(request, every_test=True), progress)
    results = context.results()
    if json:
        context.print_json(section(results))
        return
    found = minimal_of(results)
    assert found is not None
    at_most = None if everything else _LISTED
    context.print_section(title(found), [*aligned(COLUMNS, rows(found)), *remarks(found)])
    for heading, kept in (("Killed, and subsumed by none", found.dominators), ("Survivors", found.survivors)):
        if kept:
            context.print_section(heading, [described(one) for one in kept], at_most)
