"""Commands and options that are not there: what to use instead, or what to install."""

from __future__ import annotations

import re

from mutabot.extensions import not_installed

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
    "--mixed": "workers run with the same versions as this machine",
    **{
        option: f"use `mutabot motion MUTANT {option}`"
        for option in ("--test", "--video", "--view", "--rerun", "--rrd", "--mcap")
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
