"""Worker processes on this machine."""

from __future__ import annotations

from collections.abc import Callable

from mutabot.campaign.request import Request
from mutabot.campaign.workers.workers import Workers


def on_this_machine(request: Request, tell: Callable[[str], None]) -> Workers:
    """As many processes as the request has ``jobs``. Raises JournalError where it cannot write."""

    def unshared(reason: str) -> None:
        tell(f"each run starts anew, imports and collection included: {reason}")

    def left(processes: list[str]) -> None:
        more = f" and {len(processes) - 1} more" if len(processes) > 1 else ""
        tell(f"tests leave processes running, which are ended with them: {processes[0]}{more}")

    return Workers(request.root, request.arguments, request.jobs, unshared, request.pause, left)
