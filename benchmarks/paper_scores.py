"""The scores of the last campaign on examples/paper beside those that the paper reports.

Usage: python benchmarks/paper_scores.py [examples/paper]
"""

from __future__ import annotations

import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table

from mutabot.journal.journal import Journal
from mutabot.model import Verdict
from mutabot.results.results import Results, read_results

#: killed of 26 per round, from the paper's table; its text says 77 to 81 % of the same runs
PAPER_TABLE = (24, 22, 24, 23, 23)
PAPER_TEXT = "77 to 81 %"
PAPER_MUTANTS = 26
#: the paper's runs by its own sleeps: 5 rounds of 26 mutants at 148 s
PAPER_SECONDS = 148.0 * PAPER_MUTANTS * len(PAPER_TABLE)


def main() -> None:
    """Print one row per round."""
    project = Path(sys.argv[1] if len(sys.argv) > 1 else "examples/paper")
    with Journal.open(project / ".mutabot" / "journal.sqlite") as journal:
        results = read_results(journal)
        meta = journal.meta()
    table = Table(title="beside the paper (it counts a refused motion as killed; mutabot leaves it out)")
    for heading in (
        "round",
        "score (killed / valid)",
        "killed or refused of 26",
        "paper's table",
        "paper's text",
    ):
        table.add_column(heading, justify="right")
    for round in range(int(meta["rounds"])):
        killed, valid, refused = _counts(results, round)
        paper = PAPER_TABLE[round] if round < len(PAPER_TABLE) else None
        table.add_row(
            str(round + 1),
            f"{killed}/{valid} = {killed / valid:.0%}",
            f"{killed + refused}/{PAPER_MUTANTS} = {(killed + refused) / PAPER_MUTANTS:.0%}",
            f"{paper}/{PAPER_MUTANTS} = {paper / PAPER_MUTANTS:.0%}" if paper is not None else "",
            PAPER_TEXT,
        )
    console = Console()
    console.print(table)
    seconds = meta.get("seconds")
    if seconds is not None:
        hours = PAPER_SECONDS / 3600
        console.print(
            f"the campaign took {seconds:.0f} s; the paper's runs take {hours:.1f} h by their sleeps"
        )
    executed = sum(outcome.acted > 0 for result in results.mutants for outcome in result.outcomes)
    console.print(f"{executed} of {PAPER_MUTANTS * int(meta['rounds'])} runs executed mutated code")


def _counts(results: Results, round: int) -> tuple[int, int, int]:
    outcomes = (result.rounds[round] for result in results.mutants)
    ends = [outcome.verdict for outcome in outcomes if outcome is not None]
    return sum(v.is_killed for v in ends), sum(v.is_valid for v in ends), ends.count(Verdict.REFUSED)


if __name__ == "__main__":
    main()
