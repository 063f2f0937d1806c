"""Worker processes on this machine."""

from __future__ import annotations

from collections.abc import Callable

from mutabot.campaign.request import Request
from mutabot.campaign.workers.workers import Workers


def executor(request: Request, tell: Callable[[str], None]) -> Workers:
    """As many processes as the request has ``jobs``. Raises JournalError where it cannot write."""

    def unshared(reason: str) -> None:
        tell(f"each run starts anew, imports and collection included: {reason}")

    return Workers(request.root, request.arguments, request.jobs, unshared, request.pause)
