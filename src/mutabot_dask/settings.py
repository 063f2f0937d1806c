"""The cluster that a campaign runs on: an address, and the files for authentication."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mutabot.api.processes import ProjectFiles, Table
from mutabot.api.reports import UsageError

if TYPE_CHECKING:
    pass

_LOCAL = re.compile(r"local:([0-9]+)")
_ADDRESS = re.compile(r"(?:tcp|tls)://(?:[^/:]+|\[[0-9a-fA-F:]+\]):0*([0-9]{1,5})")
_PORTS = 65535
_DIGITS = 9
#: characters of an address that are shown
_SHOWN = 60
#: workers that any machine can start, and that one can for each processor
_WORKERS, _PER_PROCESSOR = 32, 4


class ClusterTable(Table):
    """For a [cluster](cluster.md). With this table, `mutabot check` lists what is sent to workers."""

    files: ProjectFiles = ()
    """What is sent beside [what git tracks](cluster.md#what-is-shipped); folders and patterns may be named.

        files = ["data/table.json"]
    """
    ca: str | None = None
    """File in PEM format, relative to the project, with whom to trust for [TLS](cluster.md#tls).

        ca = "ca.pem"
    """
    cert: str | None = None
    """The same for the certificate of this machine.

        cert = "cert.pem"
    """
    key: str | None = None
    """The same for its private key.

        key = "key.pem"
    """

    @classmethod
    def of(cls, table: Table | None) -> ClusterTable:
        """Return the table of a configuration; an empty one if it has none."""
        return table if isinstance(table, cls) else cls()


@dataclass(frozen=True, slots=True)
class ClusterSettings:
    """The settings of a cluster.

    Attributes:
        address: of the scheduler, or ``local:N``, or the path of a scheduler file.
        ca, cert, key: files in PEM format for TLS; None without it.
    """

    address: str
    ca: str | None = None
    cert: str | None = None
    key: str | None = None

    def check(self) -> None:
        """Raise UsageError for invalid settings."""
        address = self.address
        name = address if len(address) <= _SHOWN else f"{address[:_SHOWN]}…"
        if self.local is not None:
            _check_count(self.local, name)
        elif self.is_file:
            if not os.path.isfile(address):  # noqa: PTH113  # a Path raises for names that no file can have
                raise UsageError(
                    f"--cluster {name}: neither an address (tcp://host:8786, tls://host:8786, local:4) "
                    "nor a scheduler file that is there"
                )
        elif not _is_address(address):
            raise UsageError(f"--cluster {name}: an address is like tcp://host:8786 or tls://host:8786")
        for option, file in (("ca", self.ca), ("cert", self.cert), ("key", self.key)):
            if file is not None and not Path(file).is_file():
                raise UsageError(f"cluster.{option} = {file!r}: there is no such file")
        if self.files and self.local is not None:
            raise UsageError(
                f"--cluster {address} makes its own certificates: certificate files go with tls://"
            )
        if self.files and address.startswith("tcp://"):
            raise UsageError(f"--cluster {address} is not encrypted: certificate files go with tls://")
        if address.startswith("tls://") and len(self.files) < 3:
            raise UsageError(
                f"--cluster {address} needs certificates: set ca, cert and key in the table cluster, "
                "or -o cluster.ca=FILE -o cluster.cert=FILE -o cluster.key=FILE"
            )

    @property
    def local(self) -> int | None:
        """The number of workers to start on this machine; None for an existing cluster."""
        match = _LOCAL.fullmatch(self.address)
        return _number(match[1]) if match is not None else None

    @property
    def is_file(self) -> bool:
        """Whether the address is read from a file."""
        return self.local is None and "://" not in self.address

    @property
    def files(self) -> tuple[str, ...]:
        """The files for TLS."""
        return tuple(file for file in (self.ca, self.cert, self.key) if file is not None)


def _is_address(address: str) -> bool:
    match = _ADDRESS.fullmatch(address)
    return match is not None and 0 < int(match[1]) <= _PORTS


def _check_count(workers: int, name: str) -> None:
    """Raise UsageError for a number of workers that this machine cannot carry."""
    if workers == 0:
        raise UsageError("--cluster local:0 has no workers; local:2 starts two on this machine")
    processors = len(os.sched_getaffinity(0))
    most = max(_WORKERS, _PER_PROCESSOR * processors)
    if workers > most:
        plural = "processor" if processors == 1 else "processors"
        raise UsageError(
            f"--cluster {name}: at most {most} workers can be started on this machine, which has "
            f"{processors} {plural}; local:{processors} keeps all of them busy"
        )


def _number(digits: str) -> int:
    """Read a number; one with more digits than Python reads becomes a power of ten."""
    return int(digits.lstrip("0") or "0") if len(digits.lstrip("0")) < _DIGITS else 10**_DIGITS
