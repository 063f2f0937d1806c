"""Certificates for a cluster on this machine: made for one run, readable by its user alone."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from mutabot.errors import ClusterError


@dataclass(frozen=True, slots=True)
class Certificates:
    """Paths of files in PEM format; whoever has the key belongs to the cluster.

    Attributes:
        ca: whom the cluster trusts: nobody but this certificate.
        cert: the certificate of all its processes.
        key: its private key.
    """

    ca: str
    cert: str
    key: str

    @classmethod
    def make(cls, folder: Path) -> Certificates:
        """New ones, in a new folder that only this user can enter. Raises ClusterError."""
        import distributed  # noqa: PLC0415  # addresses in scheduler files are read without Dask

        security: type = distributed.Security
        try:
            made = security.temporary()  # type: ignore[attr-defined]
        except ImportError as error:
            raise ClusterError(
                "--cluster local:N encrypts its connections, which needs the library cryptography: "
                f"pip install 'path/to/mutabot[cluster]' ({error})"
            ) from error
        folder.mkdir(mode=0o700)
        ca = _write(folder / "certificate.pem", made.tls_ca_file)
        return cls(ca, ca, _write(folder / "key.pem", made.tls_client_key))


def _write(file: Path, text: str) -> str:
    """Never readable by others, not even while it is written."""
    descriptor = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with os.fdopen(descriptor, "w", encoding="ascii") as stream:
        stream.write(text)
    return str(file)
