"""``mutabot live``: runs a campaign with a live page.

Its messages go to the terminal and to browsers, which can stop it.
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Annotated, Any, Self

import typer

from mutabot.api.processes import Request
from mutabot.api.reports import CampaignRun, CommandContext, LiveReport, Progress

from .pages import Pages
from .server import LiveFeed, Server

#: seconds that pages get for what was found last, when the command ends at once; and to be loaded again
_FAREWELL, _AGAIN = 1.5, 3.0
_TICK = 0.1


class Live:
    """Runs campaigns with a page; use as a context manager, and ``run`` in the main thread.

    After a campaign that has run to its end it stays as long as a browser shows the page, or until Ctrl-C.

    Args:
        request: what the campaign is asked.
        port: of this machine; 0 for any that is free.
        notify: called with each message for the user.

    Raises UsageError if the port cannot be had.
    """

    def __init__(self, request: Request, port: int, notify: Callable[[str], None]) -> None:
        self._request, self._notify = request, notify
        self._feed = LiveFeed()
        self._progress = _FeedProgress(self._feed)
        pages = Pages(request.journal_path, request.root.resolve().name, lambda: self._progress.steps)
        self._progress.pages = pages
        commands = {"stop": _stop}
        self._server = Server(pages, self._feed, commands, port)

    @property
    def address(self) -> str:
        """The address of the page."""
        return self._server.address

    def __enter__(self) -> Self:
        self._progress.publish()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if self._progress.ended == "complete":
                self._stay()
            else:
                self._wait(time.monotonic() + _FAREWELL, 0.0)
        except KeyboardInterrupt:
            pass
        finally:
            self._feed.close()
            self._server.close()

    def run(self, progress: Progress) -> Path:
        """Run the campaign to its end; return the path of its journal."""
        self._progress.show_on(progress)
        try:
            path = CampaignRun.to_end(self._request, self._progress)
        except BaseException as error:
            self._progress.end("interrupted" if isinstance(error, KeyboardInterrupt) else str(error))
            raise
        self._progress.end("complete")
        return path

    def _stay(self) -> None:
        if self._feed.is_listened_to(0.0):
            self._notify("the page stays as long as a browser shows it; Ctrl-C ends it")
        self._wait(None, _AGAIN)

    def _wait(self, until: float | None, seconds: float) -> None:
        while self._feed.is_listened_to(seconds) and (until is None or time.monotonic() < until):
            time.sleep(_TICK)


def _stop() -> None:
    """Stop like Ctrl-C, in the main thread; where SIGINT is ignored, like SIGTERM."""
    main = threading.main_thread().ident
    assert main is not None
    is_ignored = signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    signal.pthread_kill(main, signal.SIGTERM if is_ignored else signal.SIGINT)


class _FeedProgress:
    """A progress that also updates the feed.

    Attributes:
        progress: what shows it on the terminal, once there is anything to show.
        pages: what browsers ask for.
        steps: how many things happened since the journal is this campaign's; 0 before.
        ended: how the campaign ended; empty before.
    """

    pages: Pages

    def __init__(self, feed: LiveFeed) -> None:
        self._feed = feed
        self._lock = threading.Lock()
        self._stage, self._line, self._done = "", "", 0
        self._total: int | None = None
        self.progress: Progress | None = None
        self.steps, self.ended = 0, ""

    def show_on(self, progress: Progress) -> None:
        """Show progress on the terminal, too."""
        self.progress = progress
        self.mutant_ended = progress.mutant_ended  # of no use to the page, which has it from the journal

    def stage(self, text: str, total: int | None = None) -> None:
        """Begin a new stage."""
        if self.progress is not None:
            self.progress.stage(text, total)
        self._stage, self._line = text, ""
        self._done, self._total = 0, total
        self.steps += 1
        self.publish()

    def advance(self, line: str | None = None) -> None:
        """Count one more step."""
        if self.progress is not None:
            self.progress.advance(line)
        self._line = LiveReport.legible(line or "")
        self._done += 1
        self.steps += 1
        self.publish()

    @property
    def left(self) -> float | None:
        """The seconds left in the stage; None if unknown."""
        return None if self.progress is None else self.progress.left

    def note(self, text: str) -> None:
        """Show a note to the user."""
        if self.progress is not None:
            self.progress.note(text)
        self._feed.note(LiveReport.legible(text))

    def end(self, how: str) -> None:
        """Note that the campaign has ended."""
        self.ended = LiveReport.legible(how)
        self.steps += 1
        self.pages.look_at_once()
        self.publish()

    def publish(self) -> None:
        """Send the current state to the feed."""
        with self._lock:
            left = self.left
            state: dict[str, Any] = {
                "stage": self._stage,
                "line": self._line,
                "done": self._done,
                "total": self._total,
                "left": None if left is None else round(left, 1),
                "ended": self.ended,
                "version": self.steps,
                "every": self.pages.every,
            }
            self._feed.put(state)


Port = Annotated[
    int | None,
    typer.Option("--port", metavar="N", min=1, max=65535, help="Port on this machine; else a free one."),
]


def live(
    context: CommandContext,
    request: Request,
    port: Port = None,
    min_score: float | None = None,
    json: bool = False,
) -> None:
    """Run the campaign and show its report in a browser while it fills, with a button to stop."""
    with Live(request, port or 0, lambda text: context.notify([f"mutabot: {text}"])) as served:
        context.notify([f"mutabot: live at {served.address}"])
        context.run_to_end(request, served.run, min_score, json=json)
