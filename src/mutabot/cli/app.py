"""The command line. ``main`` alone turns exceptions into exit codes.

A command is imported when it runs, so that ``--help`` is fast. SIGTERM ends a command as Ctrl-C does.
"""

from __future__ import annotations

import argparse
import importlib
import os
import re
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from mutabot.errors import ExitCode, MutabotError, UsageError, shortened
from mutabot.execution.interruption import interrupt
from mutabot.extensions import brought, not_installed

from .options import Version
from .parameters import with_options
from .streams import guarded_streams

#: characters of a message about the command line
_LONGEST = 400
#: mutabot's own commands: their module in this folder, and what ``--help`` says of them
_OWN = {
    "check": ("campaign:check", "Try the set-up: tests, sites, and the two control mutants."),
    "list": ("campaign:list_", "List the mutants that would run."),
    "operators": ("campaign:operators", "List the operators and the bugs they stand for."),
    "run": ("campaign:run", "Run the campaign, or continue it."),
    "merge": ("campaign:merge", "Merge the journals of shards."),
    "replay": ("campaign:replay", "Re-run one mutant in fresh processes."),
    "results": ("results:results", "List mutants, scores and survivors."),
    "show": ("results:show", "Show the details of one mutant."),
    "accept": ("accept:accept", "Accept survivors, with a reason."),
    "thresholds": ("results:thresholds", "Show how large a fault the tests miss."),
    "report": ("results:report", "Write pages, or formats of other tools."),
}
#: options and a command of earlier versions, and what serves instead
_GONE = {
    "--selection": "use --only @FILE",
    "--when": "use -o when=MOMENT",
    "--baseline": "use -o baseline_repetitions=N",
    "--table": "`mutabot results` prints the table",
    "--serve": "`mutabot live` runs a campaign with its page",
    "--confirm": "use --verify N",
    "--repeats": "kills that may be a coincidence are re-run anyway",
    "--no-repeats": "use -o repeats=false",
    "--one-per-site": "use --sample",
    "--sites-only": "--since runs what a change can have altered",
    "--whole-ladders": "every magnitude is run only where the search needs it",
    "--mixed": "workers run with the same versions as this machine",
    "--view": "`mutabot motion MUTANT --rerun` shows what was recorded",
    "--write": "apply the diff that `mutabot suggest` prints",
    **dict.fromkeys(("--order", "--pairs"), "a mutant is one fault, no pair of them"),
    "--suggest-demands": "write a demand with a magnitude that `mutabot thresholds` shows",
    "--all": "`mutabot list --all` lists what is left out as well",
    "--compare": "`mutabot.open` reads both campaigns in Python",
    **dict.fromkeys(("--steps", "--sort", "--picture"), "`mutabot thresholds --json` has every magnitude"),
    **dict.fromkeys(("--video", "--rerun", "--rrd", "--mcap"), "use `mutabot motion MUTANT`"),
    **dict.fromkeys(
        ("--tls-ca", "--tls-cert", "--tls-key"), "use -o cluster.ca=FILE, cluster.cert or cluster.key"
    ),
    "compare": "`make comparison` in a clone of mutabot compares families of mutants",
}
#: what is enough to operate mutabot without any other page; ``\b`` keeps the lines as they are
_MANUAL = """\b
A project has [tool.mutabot] in pyproject.toml, or mutabot.toml, and a
vocabulary of its robot API. `mutabot init` drafts both. Then:
  mutabot check             are the tests usable, how long will a run take
  mutabot run               run all mutants; Ctrl-C, and `run` goes on
  mutabot run --only WHICH  16-20, mission.py:22, reverse, "tests/*.py"
  mutabot results           all mutants again; survivors are what to work on
  mutabot show 5            what survivor 5 did, and what let it through
  mutabot suggest --only 5  a check that kills it, as a diff
  mutabot accept 5 --why …  it may survive: into mutabot-accepted.toml
\b
For scripts and agents; results go to stdout, progress to stderr:
  mutabot run --format lines   SURVIVED, KILLED, REFUSED … and, after tabs,
                               number, place, operator, fault, reason
  mutabot run --format jsonl   the same as JSON Lines, as mutants are judged
  mutabot run --fail-on survivors --fail-on untested   exit 1 if there are any
  mutabot show 5 --json        source, fault, story, checks, suggestion
\b
Exit codes: 0 fine; 1 a limit is missed (--min-score, --fail-on); 2 command
line or file is wrong; 3 the tests fail on the original, or no mutant counts;
4 results are unreliable; 5 too many time-outs. Your program and tests are
never changed; what mutabot keeps is in .mutabot, not to be committed.
"""
#: settings of every command, mutabot's own and those of packages
SETTINGS: dict[str, Any] = {
    "context_settings": {"help_option_names": ["-h", "--help"]},
    "pretty_exceptions_enable": False,
    "rich_markup_mode": None,
}


class Commands(TyperGroup):
    """The commands of mutabot and of packages.

    A command is a function; ``cli.parameters`` says what its parameters stand for.
    """

    def list_commands(self, ctx: Any) -> list[str]:
        """Return all names, in the order in which ``--help`` lists them."""
        names = [*_OWN]
        for part in brought("commands", _OWN).values():
            names.insert(names.index(part.before) if part.before in names else len(names), part.name)
        return names

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return the help of a command; None if there is no such command."""
        if cmd_name in _OWN:
            return _command(cmd_name, lambda: None, _OWN[cmd_name][1])
        part = brought("commands", _OWN).get(cmd_name)
        return None if part is None else _command(cmd_name, lambda: None, part.help)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the name of the command to run, the command, and its arguments."""
        if args and args[0] not in _OWN:
            names: Any = dict.fromkeys(self.list_commands(ctx))
            self.commands = names  # typer suggests the nearest of these
        name, _, rest = super().resolve_command(ctx, args)
        return name, _command(str(name), with_options(function_of(str(name)))), rest


def function_of(name: str) -> Callable[..., object]:
    """Import the function of a command."""
    if name in _OWN:
        module, _, attribute = _OWN[name][0].partition(":")
        return getattr(importlib.import_module(f"mutabot.cli.{module}"), attribute)  # type: ignore[no-any-return]
    return brought("commands", _OWN)[name].load_function()


def _command(name: str, function: Callable[..., object], help: str | None = None) -> Any:
    application = typer.Typer(add_completion=False, **SETTINGS)
    application.command(name, help=help)(function)
    return typer.main.get_command(application)


@contextmanager
def terminated_like_ctrl_c() -> Iterator[list[int]]:
    """Treat SIGTERM like Ctrl-C, even where Ctrl-C is ignored; yield a list that is empty until one comes.

    Does nothing outside the main thread, which alone receives signals, and where SIGTERM is handled or
    ignored already.
    """
    come: list[int] = []

    def end(number: int, frame: FrameType | None) -> None:
        come.append(number)
        on_interrupt = signal.getsignal(signal.SIGINT)
        (on_interrupt if callable(on_interrupt) else interrupt)(signal.SIGINT, frame)

    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield come
        return
    signal.signal(signal.SIGTERM, end)
    try:
        yield come
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


app = typer.Typer(
    name="mutabot",
    help="Mutation testing for robot programs: would your tests notice?",
    epilog=_MANUAL,
    no_args_is_help=True,
    cls=Commands,
    **SETTINGS,
)


@app.callback()
def options(
    context: typer.Context,
    project: Annotated[
        Path | None,
        typer.Option(
            "-C",
            "--project",
            metavar="FOLDER",
            help="The project; by default this folder, or the nearest above it with a configuration.",
        ),
    ] = None,
    version: Version = False,
) -> None:
    """Mutation testing for robot programs: would your tests notice?"""
    if not sys.platform.startswith("linux"):
        raise UsageError(
            f"mutabot runs on Linux only; this is {sys.platform}: use a container or a virtual machine"
        )
    context.obj = project if project is not None else project_of(Path.cwd())


def project_of(folder: Path) -> Path:
    """Return the nearest project from this folder upwards, relative to it; this folder if there is none."""
    above = (path for path in (folder, *folder.parents) if _is_project(path))
    return Path(os.path.relpath(next(above, folder), folder))


def _is_project(folder: Path) -> bool:
    """Return whether a folder has a configuration, or a journal."""
    if any((folder / name).exists() for name in ("mutabot.toml", ".mutabot")):
        return True
    try:
        text = (folder / "pyproject.toml").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False
    return "[tool.mutabot" in text


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code of the process."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a terminal that cannot show a character gets "?", not an error
            stream.reconfigure(errors="replace")
    arguments = sys.argv[1:] if arguments is None else arguments
    with guarded_streams() as output, terminated_like_ctrl_c() as terminated:
        code = _code_of(arguments)
        if output.fault is not None and code == ExitCode.FINE:  # the parser has passed over it
            typer.echo(f"mutabot: standard output cannot be written: {output.fault}", err=True)
            code = ExitCode.USAGE
        if code == ExitCode.INTERRUPTED:
            how = "ended by SIGTERM" if terminated else "interrupted"
            typer.echo(f"{how}; `mutabot results` shows the results so far", err=True)
    return ExitCode.TERMINATED if code == ExitCode.INTERRUPTED and terminated else code


def _code_of(arguments: Sequence[str]) -> int:
    try:
        code = app(list(arguments), prog_name="mutabot", standalone_mode=False)
        with suppress(BrokenPipeError):
            sys.stdout.flush()
    except (KeyboardInterrupt, typer.Abort):
        return ExitCode.INTERRUPTED
    except MutabotError as error:
        typer.echo(f"mutabot: {error}", err=True)
        return error.exit_code
    except Exception as error:
        show = getattr(error, "show", None)
        is_usage = callable(show) and hasattr(error, "exit_code")  # the parser's own errors
        return _usage_error(error) if is_usage else _crash(error, arguments)
    return code if isinstance(code, int) else ExitCode.FINE  # typer itself makes INTERRUPTED of Ctrl-C


def _usage_error(error: Any) -> int:
    instead = _instead(error)
    if instead is not None:
        typer.echo(f"mutabot: {instead}", err=True)
    else:
        error.message = shortened(str(getattr(error, "message", "")), _LONGEST)
        error.show()
    return ExitCode.USAGE


def _instead(error: Any) -> str | None:
    """Return the replacement of an option or a command that is gone, or the package that brings one."""
    option: str = getattr(error, "option_name", None) or ""
    found = re.match(r"No such command '([^']*)'", getattr(error, "message", ""))
    command = found[1] if found is not None else ""
    for name, what in ((option, option), (command, f"the command {command}")):
        if name in _GONE:
            return f"{what} is gone; {_GONE[name]}"
    missing = not_installed(option.removeprefix("--"), "executors") or not_installed(command, "commands")
    return None if missing is None else f"{option or f'the command {command}'} {missing}"


def _crash(error: Exception, arguments: Sequence[str]) -> int:
    text = "".join(traceback.format_exception(error))
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("-C", "--project", type=Path, default=Path())
    file: Path = parser.parse_known_args(arguments)[0].project / ".mutabot" / "crash.txt"
    try:
        file.parent.mkdir(exist_ok=True)
        file.write_text(text, encoding="utf-8")
    except OSError:
        typer.echo(text, err=True)
        file = Path("the lines above")
    typer.echo(f"mutabot: internal error ({type(error).__name__}: {error}); details are in {file}", err=True)
    return ExitCode.INTERNAL_ERROR


if __name__ == "__main__":
    sys.exit(main())
