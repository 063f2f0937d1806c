"""The options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from mutabot import __version__
from mutabot.families import FAMILIES

_KINDS = Path(__file__).parent.parent / "campaign" / "engines" / "kinds"
#: an engine is a file; its name is told without loading it, so that `--help` is fast
ENGINES = ("auto", *sorted(file.stem for file in _KINDS.glob("[!_]*.py")))


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"mutabot {__version__}")
        raise typer.Exit


Version = Annotated[
    bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON, for a machine to read.")]
All = Annotated[bool, typer.Option("--all", help="Also list every mutant that the plan leaves out.")]
Only = Annotated[
    list[str] | None,
    typer.Option(
        "--only",
        metavar="WHICH",
        help="Only these: id, number, numbers (3,16-20), file, file:line, operator, family or role; "
        "globs too. Repeatable.",
    ),
]
Skip = Annotated[list[str] | None, typer.Option("--skip", metavar="WHICH", help="All but these, likewise.")]
Families = Annotated[
    list[str] | None,
    typer.Option(
        "--family",
        metavar="NAME",
        help=f"Families of mutants: {', '.join(FAMILIES)}. Repeatable, or with commas.",
        autocompletion=lambda: list(FAMILIES),
    ),
]
WholeLadders = Annotated[
    bool,
    typer.Option(
        "--whole-ladders", help="Run every magnitude of graded faults, not only what a search needs."
    ),
]
When = Annotated[
    list[str] | None,
    typer.Option(
        "--when",
        metavar="MOMENT",
        help='At which calls of its site a mutant acts: every, 3, "from 10", once, "2-2.5 s". Repeatable.',
    ),
]
Order = Annotated[
    int | None,
    typer.Option("--order", metavar="1|2", min=1, max=2, help="Mutants at once: 2 plants pairs of them."),
]
Pairs = Annotated[
    int | None, typer.Option("--pairs", metavar="N", min=1, help="How many pairs --order 2 plants.")
]
Selection = Annotated[
    Path | None, typer.Option("--selection", metavar="FILE", help="File with one mutant id per line.")
]
Sample = Annotated[
    str | None,
    typer.Option(
        "--sample",
        metavar="SIZE",
        help="Only a random sample: 10% of each family and role, or 50 of each family.",
    ),
]
OnePerSite = Annotated[
    bool, typer.Option("--one-per-site", help="Only one mutant per family and site, chosen at random.")
]
Rounds = Annotated[
    int | None, typer.Option("--rounds", metavar="N", min=1, help="Repetitions, each with its own seeds.")
]
Seed = Annotated[int | None, typer.Option("--seed", metavar="N", min=0, help="The campaign's seed.")]
Jobs = Annotated[int | None, typer.Option("-j", "--jobs", metavar="N", min=1, help="Runs at work at a time.")]
Engine = Annotated[
    str,
    typer.Option(
        "--engine",
        metavar="ENGINE",
        help=f"What runs the mutants: {', '.join(ENGINES)}.",
        autocompletion=lambda: list(ENGINES),
    ),
]
OneMutant = Annotated[
    str, typer.Argument(metavar="MUTANT", help="The mutant's number or id, or as much of it as is unique.")
]
Table = Annotated[bool, typer.Option("--table", help="Print every mutant at the end, not only a summary.")]
Part = Annotated[
    str | None,
    typer.Option("--shard", metavar="N/M", help="Run only part N of M; `mutabot merge` puts them together."),
]
Fresh = Annotated[bool, typer.Option("--fresh", help="Run everything again, also outcomes that still hold.")]
Since = Annotated[
    str | None,
    typer.Option(
        "--since",
        metavar="REF",
        help="Run only what changes since this revision of git can have altered; take over the rest.",
    ),
]
SitesOnly = Annotated[
    bool,
    typer.Option(
        "--sites-only",
        help="With --since: presume that mutants whose own statement, operation and tests are unchanged end "
        "as before, also where other program text has changed.",
    ),
]
OtherJournal = Annotated[
    Path | None,
    typer.Option(
        "--journal", metavar="PATH", help="Take over what still holds from this journal as well, as of CI."
    ),
]
Budget = Annotated[
    str | None,
    typer.Option(
        "--budget",
        metavar="TIME",
        help="End within this time (90s, 10m, 1h30m), baseline included: run first what tells most.",
    ),
]
Verify = Annotated[
    int,
    typer.Option(
        "--verify",
        metavar="N",
        min=0,
        help="Run N random outcomes once more in fresh processes; exit with 4 if one ends otherwise.",
    ),
]
Confirm = Annotated[
    bool,
    typer.Option("--confirm", help="Run every kill, survivor and time-out once more; else unstable."),
]
Repeats = Annotated[
    bool, typer.Option("--repeats/--no-repeats", help="Run kills that may be chance once more.")
]
BaselineRuns = Annotated[
    int | None, typer.Option("--baseline", metavar="N", min=1, help="Run the original N times per round.")
]
Round = Annotated[int | None, typer.Option("--round", metavar="N", min=1, help="Only this round.")]
Cluster = Annotated[
    str | None,
    typer.Option(
        "--cluster",
        metavar="WHERE",
        help="Run mutants on a Dask cluster: tcp://host:8786, tls://…, local:4, or a scheduler file.",
    ),
]
Mixed = Annotated[
    bool, typer.Option("--mixed", help="With --cluster: workers may run with other versions than here.")
]
TlsCa = Annotated[
    str | None, typer.Option("--tls-ca", metavar="FILE", help="With --cluster: certificates to trust.")
]
TlsCert = Annotated[
    str | None, typer.Option("--tls-cert", metavar="FILE", help="With --cluster: our certificate.")
]
TlsKey = Annotated[str | None, typer.Option("--tls-key", metavar="FILE", help="With --cluster: its key.")]
Serve = Annotated[
    bool,
    typer.Option(
        "--serve",
        help="Show the report in a browser while it fills, with pause and stop. Prints its address.",
    ),
]
Port = Annotated[
    int | None,
    typer.Option(
        "--port", metavar="N", min=1, max=65535, help="Port of --serve on this machine; else a free one."
    ),
]
MinScore = Annotated[
    float | None,
    typer.Option(
        "--min-score",
        metavar="PERCENT",
        min=0,
        max=100,
        help="Exit with 1 if a score is under this many percent.",
    ),
]
