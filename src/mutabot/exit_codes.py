"""With which number a command ends, and what that says."""

from __future__ import annotations

from enum import IntEnum


class ExitCode(IntEnum):
    """The numbers; ``meaning`` is what docs/verdicts.md says of each."""

    meaning: str

    def __new__(cls, code: int, meaning: str) -> ExitCode:
        """A number with what it means."""
        member = int.__new__(cls, code)
        member._value_, member.meaning = code, meaning
        return member

    FINE = 0, "fine"
    SCORE_TOO_LOW = (
        1,
        "a score is under `--min-score` (or `min_score` in the configuration), in percent, or a site "
        "tolerates more than a `demand` allows",
    )
    USAGE = 2, "the command line or a file is wrong"
    NOTHING_KNOWN = 3, "the tests fail on the original, there are no mutants, or none of them was valid"
    UNRELIABLE = (
        4,
        "a control ended wrongly, more errors than `error_limit` allows, too much is unstable, `--verify` "
        "found a disagreement, the journal lacks an outcome, or `mutabot merge` lacks a shard",
    )
    TOO_MANY_TIMEOUTS = 5, "more time-outs than `timeout_limit` allows"
    INTERNAL_ERROR = 70, "an internal error; `.mutabot/crash.txt` has the details"
    INTERRUPTED = 130, "interrupted by Ctrl-C; `mutabot results` shows the results so far"
    TERMINATED = 143, "ended by SIGTERM, as Ctrl-C ends it; `mutabot results` shows the results so far"
