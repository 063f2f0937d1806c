"""What a process said before it ended, for people to read."""

from __future__ import annotations

import re

#: pytest's exit statuses after which a run of the suite says nothing about its tests
ABNORMAL = {2: "it was interrupted", 3: "an internal error", 4: "a wrong command line or configuration"}
_ESCAPES = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07]*\x07|.)")
#: what pytest prints around a mistake explains nothing
_OF_NO_USE = re.compile(
    r"\s*(inifile|rootdir|configfile|cachedir|plugins|testpaths): |platform |collected \d|=+ .* =+$"
    r"|.*usage: .*\[options\]"
)
_LINES = 20


def said_in(log: str) -> str:
    """The last lines of what a process printed, in their own layout, as an appendix to a message."""
    lines = [line.rstrip() for line in _ESCAPES.sub("", log).splitlines() if line.strip()]
    lines = [_without_frame(line) for line in lines if not _OF_NO_USE.match(line)] or lines
    if not lines:
        return ""
    return "; pytest said:" + "".join(f"\n  {line}" for line in lines[-_LINES:])


def _without_frame(line: str) -> str:
    """A line without the exclamation marks that pytest fills it up with."""
    return line.strip("! ") if line.startswith("!!!") else line


def last_line(log: str) -> str:
    """The last line with text in it."""
    lines = [line.strip() for line in log.splitlines() if line.strip()]
    return lines[-1][:300] if lines else ""
