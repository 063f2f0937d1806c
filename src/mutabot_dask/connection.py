"""The connection to a campaign's scheduler and workers, which is restored if the scheduler is lost."""

from __future__ import annotations

import shutil
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from functools import cached_property
from pathlib import Path

from mutabot.api.processes import Request, Workers, interruptible
from mutabot.api.reports import UsageError

from .bundle import Bundle, summary, warnings
from .environment import decided, module_folders
from .link import Link, is_private
from .local import LocalCluster, address_in
from .roster import Roster
from .settings import ClusterSettings
from .shipping import Shipment
from .unit import SharedData

#: seconds to wait for those that are there to say who they are, and for a scheduler that is gone
_INTRODUCTION, _RETURN = 30.0, 60.0
#: how often in a row a scheduler of our own is started again without a unit done in between
_STARTS = 3
#: seconds that workers get to let go at the end
_FAREWELL = 2.0


class ClusterConnection:
    """A cluster, and the project as its workers have it.

    Args:
        request: the campaign.
        settings: the cluster.
        notify: called with messages for the user.

    Attributes:
        link: the connection to the scheduler.
        roster: the workers.
        done: units that were run since the scheduler was reached.
        is_given_up: whether what is left runs on this machine.

    Raises UsageError where no scheduler answers, or a worker does not fit.
    """

    def __init__(self, request: Request, settings: ClusterSettings, notify: Callable[[str], None]) -> None:
        self.notify = notify
        self.done = 0
        self.is_given_up = False
        self._request, self._settings = request, settings
        self._local: LocalCluster | None = None
        self._restarts = 0
        with ExitStack() as stack:
            if settings.local is not None:
                folder = Path(tempfile.mkdtemp(prefix="mutabot-cluster-"))
                stack.callback(_remove, folder)
                self._local = LocalCluster(settings.local, folder)
                stack.callback(self._local.close)
                own = self._local.certificates
                self._settings = replace(settings, ca=own.ca, cert=own.cert, key=own.key)
            self.link = Link(self._settings, self._address())
            self.roster = Roster(self.link, Workers.versions(), notify)
            stack.callback(self._dismiss)
            if not is_private(self.link.address):
                notify(
                    f"the connection to {self.link.address} is not encrypted: anyone who can reach its port "
                    "can run programs on the workers; tls:// closes it (docs/cluster.md, TLS)"
                )
            self._check_versions()
            self._ends = stack.pop_all()

    @property
    def size(self) -> int:
        """The number of workers, or of expected workers."""
        return len(self.roster.usable) or self._settings.local or 0

    def close(self) -> None:
        """Make workers forget the campaign, and end what was started for it."""
        self._ends.close()

    @cached_property
    def ground(self) -> SharedData:
        """The data shared by all units. The first access sends the project to the workers."""
        root, shipment = self._request.root, Shipment.of(self._request)
        bundle = self.roster.bundle = Bundle.make(shipment)
        for text in (f"workers are sent {summary(bundle)}", *warnings(shipment, bundle)):
            self.notify(text)
        paths = module_folders(root)
        return SharedData(bundle.digest, str(root), bundle.inner, self._request.arguments, decided(), paths)

    def give_up(self, why: str) -> None:
        """Leave the remaining tasks to this machine."""
        self.is_given_up = True
        self.notify(f"{why}: the campaign goes on on this machine, {self._request.jobs} at a time")

    def restart_workers(self) -> None:
        """Restart workers on this machine that have ended."""
        if self._local is not None and self._local.restart_lost_workers():
            self.notify("the workers on this machine were gone, and are started again")

    def reconnect(self) -> bool:
        """Reconnect to the lost scheduler, or to another one in its place; return whether that worked."""
        self.link.close()
        self._restarts = self._restarts + 1 if self.done == 0 else 1
        self.done = 0
        if self._local is not None and self._restarts > _STARTS:
            return False
        how = "is started again" if self._local else f"is given {_RETURN:.0f} s to come back"
        self.notify(f"the scheduler at {self.link.address} is gone; outcomes so far are kept, and it {how}")
        until = time.monotonic() + _RETURN
        while True:
            try:
                with interruptible():
                    self.link = Link(self._settings, self._address())
                break
            except UsageError:
                if time.monotonic() > until:
                    return False
                with interruptible():
                    time.sleep(1.0)
        before = self.roster
        self.roster = Roster(self.link, before.versions, self.notify, before.bundle, before.reported)
        return True

    def _address(self) -> str:
        """Return the address of the scheduler; start one of our own if necessary."""
        if self._local is not None:
            return self._local.start()
        return address_in(Path(self._settings.address)) if self._settings.is_file else self._settings.address

    def _check_versions(self) -> None:
        """Ask the connected workers for their versions. Raises UsageError if one does not match."""
        if self._local is not None:
            return
        until = time.monotonic() + _INTRODUCTION
        self.roster.update()
        if not self.link.workers:
            self.notify(f"no worker is at {self.link.address} yet")
        while not self.roster.is_settled and time.monotonic() < until:
            with interruptible():
                time.sleep(0.05)
            while not self.link.replies.empty():
                self.roster.take(self.link.replies.get())
            self.roster.update()
        if self.roster.refusals:
            address, why = next(iter(self.roster.refusals.items()))
            more = len(self.roster.refusals) - 1
            others = f", and {more} more" if more else ""
            raise UsageError(f"worker {address}{others} cannot be used: {why}")

    def _dismiss(self) -> None:
        if not self.link.is_lost and self._local is None:
            self.roster.dismiss()
            until = time.monotonic() + _FAREWELL
            while not self.roster.is_idle and time.monotonic() < until:
                time.sleep(0.02)
        self.link.close()


def _remove(folder: Path) -> None:
    """Remove the folder of a cluster; tests that end with their workers may still write to it."""
    until = time.monotonic() + _FAREWELL
    while folder.exists() and time.monotonic() < until:
        shutil.rmtree(folder, ignore_errors=True)
