"""The command line. Exceptions become exit codes in ``main`` and nowhere else.

Each group of commands has a file; what a command needs is imported inside it, so that ``--help`` is fast.
SIGTERM ends a command as Ctrl-C does: nothing is lost, and nothing is left behind.
"""

from __future__ import annotations

import re
import signal
import sys
import threading
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import zip_longest
from pathlib import Path
from types import FrameType
from typing import Annotated

import typer

from mutabot.cli import campaign, report, results, thresholds
from mutabot.errors import ExitCode, MutabotError, UsageError
from mutabot.extensions import not_installed
from mutabot.limits import shortened

from .commands import SETTINGS, Commands
from .options import Version, with_options

_COMMANDS = {"compare": "`make comparison` in a clone of mutabot compares families of mutants"}
_OPTIONS = {
    "--selection": "use --only @FILE",
    "--when": "use -o when=MOMENT",
    **dict.fromkeys(("--order", "--pairs"), "a mutant is one fault, no pair of them"),
    "--baseline": "use -o baseline_repetitions=N",
    "--table": "`mutabot results` prints the table",
    "--serve": "`mutabot live` runs a campaign with its page",
    "--tls-ca": "use -o cluster.ca=FILE",
    "--tls-cert": "use -o cluster.cert=FILE",
    "--tls-key": "use -o cluster.key=FILE",
    "--one-per-site": "use --sample",
    "--whole-ladders": "every magnitude is run only where the search needs it",
    "--sites-only": "--since runs what a change can have altered",
    "--confirm": "use --verify N",
    "--repeats": "kills that may be a coincidence are re-run anyway",
    "--no-repeats": "use -o repeats=false",
    "--write": "apply the diff that it prints",
    "--view": "`mutabot motion MUTANT --rerun` shows what was recorded",
    "--mixed": "workers run with the same versions as this machine",
    **{
        option: f"use `mutabot motion MUTANT {option}`"
        for option in ("--test", "--video", "--rerun", "--rrd", "--mcap")
    },
}


def gone(error: Exception) -> str | None:
    """What to say of the parser's error; None if it is about nothing that there ever was, or could be."""
    option: str = getattr(error, "option_name", None) or ""
    if option in _OPTIONS:
        return f"{option} is gone; {_OPTIONS[option]}"
    found = re.match(r"No such command '([^']*)'", getattr(error, "message", ""))
    command = found[1] if found is not None else ""
    if command in _COMMANDS:
        return f"the command {command} is gone; {_COMMANDS[command]}"
    missing = not_installed(option.removeprefix("--"), "executors") or not_installed(command, "commands")
    return None if missing is None else f"{option or f'the command {command}'} {missing}"


class Termination:
    """The handler of SIGTERM.

    Attributes:
        has_come: whether there was one.
    """

    def __init__(self) -> None:
        self.has_come = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Do what Ctrl-C does at this moment."""
        self.has_come = True
        on_interrupt = signal.getsignal(signal.SIGINT)
        if callable(on_interrupt):
            on_interrupt(signal.SIGINT, frame)


@contextmanager
def terminated_like_ctrl_c() -> Iterator[Termination]:
    """Inside, SIGTERM does what Ctrl-C does.

    Does nothing in other threads than the main one, which Python tells nothing of signals, and where somebody
    else handles it already or it is ignored.
    """
    termination = Termination()
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield termination
        return
    signal.signal(signal.SIGTERM, termination)
    try:
        yield termination
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


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
app.command(rich_help_panel=_SETUP)(campaign.init)
app.command(rich_help_panel=_SETUP)(with_options(campaign.check))
app.command("list", rich_help_panel=_SETUP)(with_options(campaign.list_))
app.command(rich_help_panel=_SETUP)(campaign.operators)
app.command(rich_help_panel=_RUN)(with_options(campaign.run))
app.command(rich_help_panel=_RUN)(campaign.merge)
app.command(rich_help_panel=_RUN)(results.replay)
app.command(rich_help_panel=_RUN)(results.suggest)
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
