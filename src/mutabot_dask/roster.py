"""The workers of a cluster as the controller knows them: their versions, and which have the project."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

from . import worker_side
from .bundle import Bundle
from .environment import differences
from .link import Link, WorkerReply, one_line
from .unit import Introduction, InvalidData

#: how often a worker may fail to say who it is, or to take the project
_FAILURES = 3
#: units that may fail at a worker one after the other
_FAILED_UNITS = 2
#: differences that are named, and workers that are reported
_SHOWN, _MOST = 5, 10


@dataclass(slots=True)
class _ClusterWorker:
    """One worker.

    Attributes:
        asked: numbers of what it was asked and has not answered.
        fault: what went wrong with one of them, or None.
        failures: how often in a row something did.
        is_known: whether it runs with the same.
        is_fit: whether units can be given to it.
        refused: why it is not used, or None.
        failed: the units that it has failed since it last ran one.
        is_proven: whether it has run any.
        is_left_out: whether it is not used because of these units.
    """

    asked: set[int] = field(default_factory=set)
    fault: str | None = None
    failures: int = 0
    is_known: bool = False
    is_fit: bool = False
    refused: str | None = None
    failed: set[int] = field(default_factory=set)
    is_proven: bool = False
    is_left_out: bool = False


@dataclass
class Roster:
    """All workers of a cluster.

    Args:
        link: the connection.
        versions: what this machine runs with.
        notify: called with workers that are not used, once for each reason.

    Attributes:
        bundle: the project; None as long as it is not needed.
        reported: messages to users, in order.
    """

    link: Link
    versions: Mapping[str, str]
    notify: Callable[[str], None]
    bundle: Bundle | None = None
    reported: dict[str, None] = field(default_factory=dict)
    _workers: dict[str, _ClusterWorker] = field(default_factory=dict)
    _asked: dict[int, str] = field(default_factory=dict)

    @property
    def fit(self) -> list[str]:
        """The workers to which units can be given."""
        return [address for address, worker in self._workers.items() if worker.is_fit]

    @property
    def usable(self) -> list[str]:
        """The workers that are usable or may become so."""
        return [address for address, worker in self._workers.items() if worker.refused is None]

    @property
    def is_settled(self) -> bool:
        """Whether all connected workers have reported their versions."""
        return not self._asked and all(worker.is_known or worker.refused for worker in self._workers.values())

    @property
    def is_idle(self) -> bool:
        """Whether all requests have been answered."""
        return not self._asked

    @property
    def refusals(self) -> dict[str, str]:
        """The reasons why workers are not used, by their address."""
        return {
            address: worker.refused for address, worker in self._workers.items() if worker.refused is not None
        }

    def update(self) -> set[str]:
        """Add new workers; return the workers that have gone."""
        there = self.link.workers
        gone = self._workers.keys() - there.keys()
        for address in gone:
            for number in self._workers.pop(address).asked:
                self._asked.pop(number, None)
        for address in there:
            worker = self._workers.setdefault(address, _ClusterWorker())
            is_due = not worker.is_known or (self.bundle is not None and not worker.is_fit)
            if is_due and not worker.asked and worker.refused is None:
                self._introduce(address)
        return gone

    def take(self, reply: WorkerReply) -> bool:
        """Process an answer; return whether it was for the roster."""
        address = self._asked.pop(reply.asked, None)
        if address is None:
            return False
        worker = self._workers[address]
        worker.asked.discard(reply.asked)
        if reply.data is not None and reply.data != worker_side.TAKEN:
            try:
                self._introduced(address, worker, Introduction.of(reply.data))
            except InvalidData as error:
                self.refuse(address, f"its answer does not fit: {error}")
            return True
        if reply.is_foreign:
            self.refuse(address, reply.why)
        worker.fault = worker.fault or (reply.why if reply.data is None else None)
        if not worker.asked:
            self._record_answer(address, worker)
        return True

    def _record_answer(self, address: str, worker: _ClusterWorker) -> None:
        """Record that a worker has answered all requests."""
        fault, worker.fault = worker.fault, None
        if fault is None:
            worker.is_fit, worker.failures = worker.refused is None, 0
            return
        worker.failures += 1
        if worker.failures >= _FAILURES and address in self.link.workers:
            hint = "is the same mutabot installed there, and room on its disk?"
            self.refuse(address, f"it cannot take part ({fault}): {hint}")

    def refuse(self, address: str, why: str) -> None:
        """Give a worker no more units."""
        worker = self._workers.get(address)
        if worker is not None and worker.refused is None:
            worker.refused, worker.is_fit = why, False
            self._notify_once(one_line(f"worker {address} is not used: {why}"))

    def record_run(self, address: str) -> None:
        """Note that a worker has run a unit."""
        worker = self._workers.get(address)
        if worker is not None:
            worker.is_proven = True
            worker.failed.clear()

    def record_failure(self, address: str, unit: int, tried: Collection[str], why: str) -> None:
        """Record that a unit failed on a worker. After two in a row the worker is excluded.

        What fails at two workers that have run others says nothing of them.

        Args:
            tried: all workers at which it failed.
        """
        worker = self._workers.get(address)
        proven = [
            tried_address
            for tried_address in tried
            if tried_address in self._workers and self._workers[tried_address].is_proven
        ]
        if len(proven) > 1:
            self._clear_failures(unit)
        elif worker is not None:
            worker.failed.add(unit)
            if len(worker.failed) >= _FAILED_UNITS and worker.refused is None:
                worker.is_left_out = True
                self.refuse(address, f"{len(worker.failed)} units failed there one after the other: {why}")

    def _clear_failures(self, unit: int) -> None:
        for address, worker in self._workers.items():
            worker.failed.discard(unit)
            if worker.is_left_out and len(worker.failed) < _FAILED_UNITS:
                worker.is_left_out, worker.refused, worker.is_fit = False, None, True
                self.notify(f"worker {address} is used again: what failed there fails elsewhere, too")

    def dismiss(self) -> None:
        """End the campaign on the workers, which need to keep nothing of it."""
        for address in self.usable:
            self._ask(address, worker_side.leave)

    def _introduce(self, address: str) -> None:
        self._ask(address, worker_side.introduce, self.bundle.digest if self.bundle is not None else "")

    def _ask(self, address: str, function: Callable[..., bytes], *arguments: object) -> None:
        number = self.link.ask(address, function, *arguments)
        self._asked[number] = address
        self._workers[address].asked.add(number)

    def _introduced(self, address: str, worker: _ClusterWorker, introduction: Introduction) -> None:
        differing = differences(self.versions, introduction.versions)
        if differing:
            more = f" and {len(differing) - _SHOWN} more" if len(differing) > _SHOWN else ""
            self.refuse(address, f"it runs with something else: {'; '.join(differing[:_SHOWN])}{more}")
            return
        worker.is_known = True
        if introduction.has:
            worker.is_fit = True
        elif self.bundle is not None:
            chunks = self.bundle.chunks()
            for index, chunk in enumerate(chunks):
                self._ask(address, worker_side.receive, self.bundle.digest, index, len(chunks), chunk)

    def _notify_once(self, text: str) -> None:
        if text in self.reported or len(self.reported) > _MOST:
            return
        if len(self.reported) == _MOST:
            text = "more workers differ, or are not used: they are not listed one by one"
        self.reported[text] = None
        self.notify(text)
