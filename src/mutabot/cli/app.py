"""The command line. Exceptions become exit codes in ``main`` and nowhere else.

Each group of commands has a file; what a command needs is imported inside it, so that ``--help`` is fast.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Annotated

import typer

from mutabot.errors import MutabotError, UsageError
from mutabot.exit_codes import ExitCode
from mutabot.limits import shortened

from . import campaign, init, report, results, suggest, thresholds
from .commands import SETTINGS, Commands
from .gone import gone
from .options import Version, with_options
from .termination import terminated_like_ctrl_c

#: signs of a message about the command line
_LONGEST = 400
_SETUP, _LOOK, _RUN = "Set up", "Look at results", "Run"

app = typer.Typer(
    name="mutabot",
    help="Mutation testing for robot programs: would your tests notice?",
    no_args_is_help=True,
    cls=Commands,
    **SETTINGS,
)


@app.callback()
def options(
    context: typer.Context,
    project: Annotated[Path, typer.Option("-C", "--project", metavar="FOLDER", help="The project.")] = Path(),
    version: Version = False,
) -> None:
    """Mutation testing for robot programs: would your tests notice?"""
    if not sys.platform.startswith("linux"):
        raise UsageError(
            f"mutabot runs on Linux only; this is {sys.platform}: use a container or a virtual machine"
        )
    context.obj = project


# in this order they stand in --help
app.command(rich_help_panel=_SETUP)(init.init)
app.command(rich_help_panel=_SETUP)(with_options(campaign.check))
app.command("list", rich_help_panel=_SETUP)(with_options(campaign.list_))
app.command(rich_help_panel=_SETUP)(init.operators)
app.command(rich_help_panel=_RUN)(with_options(campaign.run))
app.command(rich_help_panel=_RUN)(campaign.merge)
app.command(rich_help_panel=_RUN)(results.replay)
app.command(rich_help_panel=_RUN)(suggest.suggest)
app.command(rich_help_panel=_LOOK)(results.results)
app.command(rich_help_panel=_LOOK)(results.show)
app.command(rich_help_panel=_LOOK)(thresholds.thresholds)
app.command(rich_help_panel=_LOOK)(report.report)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code of the process."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a terminal that cannot show a sign gets "?", not an error
            stream.reconfigure(errors="replace")
    arguments = sys.argv[1:] if arguments is None else arguments
    with terminated_like_ctrl_c() as termination:
        code = _code_of(arguments)
    if code == ExitCode.INTERRUPTED:
        how = "ended by SIGTERM" if termination.has_come else "interrupted"
        typer.echo(f"{how}; `mutabot results` shows what is there", err=True)
    return ExitCode.TERMINATED if code == ExitCode.INTERRUPTED and termination.has_come else code


def _code_of(arguments: Sequence[str]) -> int:
    try:
        code = app(list(arguments), prog_name="mutabot", standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        return ExitCode.INTERRUPTED
    except MutabotError as error:
        typer.echo(f"mutabot: {error}", err=True)
        return error.exit_code
    except Exception as error:
        return _usage_or_crash(error, arguments)
    return code if isinstance(code, int) else ExitCode.FINE  # typer itself makes INTERRUPTED of Ctrl-C


def _usage_or_crash(error: Exception, arguments: Sequence[str]) -> int:
    show = getattr(error, "show", None)
    if callable(show) and hasattr(error, "exit_code"):  # the parser's own errors, for a wrong command line
        if (told := gone(error)) is not None:
            typer.echo(f"mutabot: {told}", err=True)
            return ExitCode.USAGE
        error.message = shortened(str(getattr(error, "message", "")), _LONGEST)  # type: ignore[attr-defined]
        show()
        return ExitCode.USAGE
    text = "".join(traceback.format_exception(error))
    file = _project(arguments) / ".mutabot" / "crash.txt"
    try:
        file.parent.mkdir(exist_ok=True)
        file.write_text(text, encoding="utf-8")
    except OSError:
        typer.echo(text, err=True)
        file = Path("the lines above")
    typer.echo(f"mutabot: internal error ({type(error).__name__}: {error}); details are in {file}", err=True)
    return ExitCode.INTERNAL_ERROR


def _project(arguments: Sequence[str]) -> Path:
    """The project of a command line that may be wrong elsewhere."""
    for word, following in zip_longest(arguments, arguments[1:], fillvalue=""):
        if word in ("-C", "--project"):
            return Path(following)
        if word.startswith("--project="):
            return Path(word.removeprefix("--project="))
        if word.startswith("-C"):
            return Path(word.removeprefix("-C"))
        if not word.startswith("-"):
            break  # the command: the project stands before it
    return Path()


if __name__ == "__main__":
    sys.exit(main())
