"""Commands and options that earlier versions had: what to use instead."""

from __future__ import annotations

_COMMANDS = {"compare": "`make comparison` in a clone of mutabot compares families of mutants"}
_OPTIONS = {
    "--selection": "use --only @FILE",
    "--when": "use -o when=MOMENT",
    "--order": "use -o order=2",
    "--pairs": "use -o pairs=N",
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
    "--mixed": "workers run with the same versions as this machine",
}


def gone(error: Exception) -> str | None:
    """What to say of the parser's error; None if it is about nothing that there ever was."""
    option = getattr(error, "option_name", None)
    if option in _OPTIONS:
        return f"{option} is gone; {_OPTIONS[option]}"
    message = getattr(error, "message", "")
    named = next((name for name in _COMMANDS if message.startswith(f"No such command '{name}'")), None)
    return f"the command {named} is gone; {_COMMANDS[named]}" if named is not None else None
