"""Which cluster a campaign runs on: an address, and the files that prove who is who."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from mutabot.errors import UsageError

_LOCAL = re.compile(r"local:(\d+)")
_ADDRESS = re.compile(r"(tcp|tls)://[^/:]+:\d+|(tcp|tls)://\[[0-9a-fA-F:]+\]:\d+")


class ClusterTable(BaseModel):
    """``[tool.mutabot.cluster]``: files for TLS, and further ones for workers, relative to the project."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    ca: str | None = None
    cert: str | None = None
    key: str | None = None
    files: Annotated[tuple[str, ...], Field(strict=False)] = ()


@dataclass(frozen=True, slots=True)
class ClusterSettings:
    """A cluster.

    Attributes:
        address: of the scheduler, or ``local:N``, or the path of a scheduler file.
        mixed: whether workers may differ from this machine in what they run with.
        ca, cert, key: files in PEM format for TLS; None without it.
    """

    address: str
    mixed: bool = False
    ca: str | None = None
    cert: str | None = None
    key: str | None = None

    @property
    def local(self) -> int | None:
        """How many workers to start on this machine; None for a cluster that is there."""
        match = _LOCAL.fullmatch(self.address)
        return int(match[1]) if match is not None else None

    @property
    def is_file(self) -> bool:
        """Whether the address stands in a file."""
        return self.local is None and "://" not in self.address

    @property
    def files(self) -> tuple[str, ...]:
        """The files for TLS."""
        return tuple(file for file in (self.ca, self.cert, self.key) if file is not None)


def cluster_settings(
    address: str,
    *,
    mixed: bool = False,
    ca: str | None = None,
    cert: str | None = None,
    key: str | None = None,
) -> ClusterSettings:
    """The cluster that a user has named. Raises UsageError for what cannot be one."""
    found = ClusterSettings(address, mixed, ca, cert, key)
    if found.local == 0:
        raise UsageError("--cluster local:0 has no workers; local:2 starts two on this machine")
    if found.is_file:
        if not Path(address).is_file():
            raise UsageError(
                f"--cluster {address}: neither an address (tcp://host:8786, tls://host:8786, local:4) "
                "nor a scheduler file that is there"
            )
    elif found.local is None and not _ADDRESS.fullmatch(address):
        raise UsageError(f"--cluster {address}: an address is like tcp://host:8786 or tls://host:8786")
    for option, file in (("ca", ca), ("cert", cert), ("key", key)):
        if file is not None and not Path(file).is_file():
            raise UsageError(f"--tls-{option} {file}: there is no such file")
    if found.files and (found.local is not None or address.startswith("tcp://")):
        raise UsageError(f"--cluster {address} is not encrypted: certificate files go with tls://")
    if address.startswith("tls://") and len(found.files) < 3:
        raise UsageError(f"--cluster {address} needs --tls-ca, --tls-cert and --tls-key")
    return found
