"""Open files: as many as a campaign needs may be open at a time, or it is refused before anything runs."""

from __future__ import annotations

import resource

from mutabot.errors import UsageError

#: for Python, the journal and what is recorded; for pytest with its plug-ins, and the program under test
_ALWAYS = 128
#: for each of ``-j``: a pipe and the process itself, for up to four in its place, and as much to begin them
_EACH = 16
#: for a page: its connections, and what is read to answer them
_PAGE = 128


def needed(jobs: int, *, served: bool) -> int:
    """How many files a campaign may have open at a time."""
    return _ALWAYS + _EACH * jobs + (_PAGE if served else 0)


def provide(jobs: int, *, served: bool) -> None:
    """Raise this process's limit, and with it that of all it starts, if it is too low.

    Raises UsageError if the system does not allow that.
    """
    wanted = needed(jobs, served=served)
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if _is_enough(soft, wanted):
        return
    if _is_enough(hard, wanted):
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
        return
    fewer = (hard - needed(0, served=served)) // _EACH
    advice = f", or use -j {fewer}" if fewer > 0 else ""
    raise UsageError(
        f"-j {jobs}{' with a page' if served else ''} needs {wanted} open files at a time, but the system "
        f"allows {hard} (RLIMIT_NOFILE): raise that limit (`ulimit -Hn {wanted}` as root){advice}"
    )


def _is_enough(limit: int, wanted: int) -> bool:
    return limit == resource.RLIM_INFINITY or limit >= wanted
