"""``mutabot operators``: the faults that there are."""

# Commands import what they need when they run, so that `--help` is fast; typer makes options of parameters.
# ruff: noqa: PLC0415

from __future__ import annotations

from dataclasses import asdict

from mutabot.cli import options
from mutabot.cli.output import print_json
from mutabot.cli.request import families_of


def operators(family: options.Families = None, json: options.Json = False) -> None:
    """List the operators: what each plants, where it applies, and which bugs it stands for."""
    from mutabot.campaign.plan.rules import listed_rules
    from mutabot.report.terminal.console import make_console
    from mutabot.report.terminal.listing import print_rules

    rules = [asdict(rule) for rule in listed_rules(families_of(family))]
    print_json({"operators": rules}) if json else print_rules(make_console(), rules)
