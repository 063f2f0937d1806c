"""The executor that runs tasks on a cluster, and at home what belongs there.

At home stay runs of the original: limits, what files were opened, and how equal runs differ are measured
on one machine. So do films, a control's second chance, and tasks whose wall clock ran out elsewhere: what is
slow there may be quick enough here, and a time-out is a verdict.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import replace
from itertools import chain
from pathlib import Path
from types import TracebackType

from mutabot.campaign.request import Request
from mutabot.errors import ClusterError
from mutabot.execution.interruption import interruptible
from mutabot.execution.task import Executor, Result, Task
from mutabot.execution.workers import Workers
from mutabot.model.events import Event

from .bundle import Bundle, explained, summary, warnings
from .dispatch import Dispatch, is_for_home
from .environment import decided, module_folders
from .link import Link, is_private
from .local import LocalCluster, address_in
from .roster import Roster
from .settings import ClusterSettings
from .shipping import Shipment
from .unit import Ground

#: seconds to wait for those that are there to say who they are, and for a scheduler that is gone
_INTRODUCTION, _RETURN = 30.0, 60.0
#: how often in a row a scheduler of our own is started again without a unit done in between
_STARTS = 3
#: seconds that workers get to let go at the end
_FAREWELL = 2.0


class Cluster:
    """See ``Executor``.

    Args:
        request: the campaign.
        settings: the cluster.
        home: runs what stays here.
        tell: is told what the user should know.

    Attributes:
        home, link, roster: who runs what.
    """

    def __init__(
        self, request: Request, settings: ClusterSettings, home: Executor, tell: Callable[[str], None]
    ) -> None:
        self.home, self.tell = home, tell
        self._request, self._settings = request, settings
        self._versions = Workers.versions()
        self._ground: Ground | None = None
        self._shipment: Shipment | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._local: LocalCluster | None = None
        self._is_given_up = False
        self._restarts = 0
        self.done = 0
        try:
            if settings.local is not None:
                self._folder = tempfile.TemporaryDirectory(prefix="mutabot-cluster-")
                self._local = LocalCluster(settings.local, Path(self._folder.name))
                own = self._local.certificates
                self._settings = replace(settings, ca=own.ca, cert=own.cert, key=own.key)
            self.link = Link(self._settings, self._address())
            if not is_private(self.link.address):
                tell(
                    f"the connection to {self.link.address} is not encrypted: whoever can reach its port "
                    "can run programs on the workers; tls:// closes it (docs/cluster.md, TLS)"
                )
            self.roster = Roster(self.link, self._versions, self._tell_of_worker)
            self._meet()
        except BaseException:
            self._let_go()
            raise

    @classmethod
    @contextmanager
    def opened(
        cls, request: Request, settings: ClusterSettings, tell: Callable[[str], None]
    ) -> Iterator[Cluster]:
        """Open one for a campaign, with worker processes on this machine beside it. Raises ClusterError."""
        with request.on_this_machine(tell) as home, cls(request, settings, home, tell) as found:
            yield found

    def __enter__(self) -> Cluster:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._let_go()

    @property
    def spread(self) -> int:
        """How many workers are there; see ``Executor``."""
        return max(1, len(self.roster.usable) or self._settings.local or 1)

    @property
    def remarks(self) -> list[str]:
        """What was told of workers that differ, or are of no use; see ``Executor``."""
        return list(self.roster.told)

    def apart(self) -> AbstractContextManager[Executor]:
        """One more process at home."""
        return self.home.apart()

    def run(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """See ``Executor``."""
        for event in self.events(tasks):
            if isinstance(event, Result):
                yield event

    def events(self, tasks: Iterable[Task]) -> Iterator[Result | tuple[Task, Event]]:
        """See ``Executor``. The lines of a task come when it has ended."""
        waiting = iter(tasks)
        first = next(waiting, None)
        if first is None:
            return
        waiting = chain([first], waiting)
        if is_for_home(first) or self._is_given_up:
            yield from self.home.events(waiting)
            return
        self._prepare()
        yield from Dispatch(self, self._ready_ground, waiting).events()

    def rest(self, is_awaited: Callable[[], bool], seconds: float) -> Iterator[Result | tuple[Task, Event]]:
        """See ``Executor``: what runs on workers of the cluster is heard of when it has ended."""
        return self.home.rest(is_awaited, seconds)

    def give_up(self, why: str) -> None:
        """Run all that is left at home."""
        self._is_given_up = True
        self.tell(f"{why}: the campaign goes on on this machine, {self._request.jobs} at a time")

    def look_after(self) -> None:
        """Start again what is gone of workers on this machine."""
        if self._local is not None and self._local.look_after_workers():
            self.tell("the workers on this machine were gone, and are started again")

    def reconnect(self) -> bool:
        """The scheduler is gone: reach it again, or another one in its place; returns whether that worked."""
        told, bundle = self.roster.told, self.roster.bundle
        self.link.close()
        self._restarts = self._restarts + 1 if self.done == 0 else 1
        self.done = 0
        if self._local is not None and self._restarts > _STARTS:
            return False
        how = "is started again" if self._local else f"is given {_RETURN:.0f} s to come back"
        self.tell(f"the scheduler at {self.link.address} is gone; outcomes so far are kept, and it {how}")
        until = time.monotonic() + _RETURN
        while True:
            try:
                with interruptible():
                    self.link = Link(self._settings, self._address())
                break
            except ClusterError:
                if time.monotonic() > until:
                    return False
                with interruptible():
                    time.sleep(1.0)
        self.roster = Roster(self.link, self._versions, self._tell_of_worker, bundle, told)
        return True

    def _tell_of_worker(self, text: str) -> None:
        """Tell what a worker said; of files that it lacks it is known why."""
        self.tell(explained(self._shipment, text) if self._shipment is not None else text)

    @property
    def _ready_ground(self) -> Ground:
        assert self._ground is not None
        return self._ground

    def _address(self) -> str:
        """Where the scheduler is; one of our own is started."""
        if self._local is not None:
            return self._local.start()
        return address_in(Path(self._settings.address)) if self._settings.is_file else self._settings.address

    def _meet(self) -> None:
        """Let the workers that are there say who they are. Raises ClusterError if one does not fit."""
        if self._local is not None:
            return
        until = time.monotonic() + _INTRODUCTION
        self.roster.update()
        if not self.link.workers:
            self.tell(f"no worker is at {self.link.address} yet")
        while not self.roster.is_settled and time.monotonic() < until:
            with interruptible():
                time.sleep(0.05)
            while not self.link.news.empty():
                self.roster.take(self.link.news.get())
            self.roster.update()
        if self.roster.refusals:
            address, why = next(iter(self.roster.refusals.items()))
            more = len(self.roster.refusals) - 1
            others = f", and {more} more" if more else ""
            raise ClusterError(f"worker {address}{others} cannot be used: {why}")

    def _prepare(self) -> None:
        """Pack the project, once it is known that workers are to have it."""
        if self.roster.bundle is not None:
            return
        root = self._request.root
        shipment = self._shipment = Shipment.of_configuration(self._request.configuration)
        bundle = self.roster.bundle = Bundle.make(shipment)
        self.tell(f"workers are sent {summary(bundle)}")
        for text in warnings(shipment, bundle):
            self.tell(text)
        paths = tuple(module_folders(root))
        self._ground = Ground(
            bundle.digest, str(root), bundle.inner, self._request.arguments, decided(), paths
        )

    def _let_go(self) -> None:
        with suppress(AttributeError):  # there may be no connection yet
            if not self.link.is_lost and self._local is None:
                self.roster.dismiss()
                until = time.monotonic() + _FAREWELL
                while not self.roster.is_quiet and time.monotonic() < until:
                    time.sleep(0.02)
            self.link.close()
        if self._local is not None:
            self._local.close()
        if self._folder is not None:
            with suppress(OSError):
                self._folder.cleanup()
