"""A cluster on this machine: a scheduler and its workers, in sessions of their own.

They listen on 127.0.0.1 only, talk only to those with the certificate of this run, show no dashboard, and end
with the controller, however that ends. Certificates are made for one run, and readable by its user alone.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from mutabot.api.processes import interruptible
from mutabot.api.reports import UsageError

#: what the processes run; the kernel kills them with their parent (PR_SET_PDEATHSIG)
_CODE = (
    "import ctypes, os, signal, sys\n"
    "ctypes.CDLL(None).prctl(1, signal.SIGKILL, 0, 0, 0)\n"
    "if os.getppid() != int(sys.argv[1]):\n"
    "    sys.exit(1)\n"
    "from distributed.cli.dask_{what} import main\n"
    "sys.argv[:] = ['dask-{what}', *sys.argv[2:]]\n"
    "main()\n"
)
#: settings of Dask that fit what runs here, unless the user has others
_SETTINGS = {
    "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1000000",  # the controller counts
    "DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL": "60s",
    "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",
    "DASK_DISTRIBUTED__ADMIN__SYSTEM_MONITOR__GIL__ENABLED": "False",
}
#: settings of Dask that keep others out, whatever settings the user has
_PRIVATE = {
    "DASK_DISTRIBUTED__COMM__REQUIRE_ENCRYPTION": "True",
    # Dask opens an HTTP server even without a dashboard: this one has no pages
    "DASK_DISTRIBUTED__SCHEDULER__HTTP__ROUTES": "[]",
    "DASK_DISTRIBUTED__WORKER__HTTP__ROUTES": "[]",
}
_LOOPBACK = "127.0.0.1"
#: seconds that a scheduler may take to come up
_PATIENCE = 60.0


class LocalCluster:
    """A scheduler and workers on this machine.

    Args:
        workers: how many; 0 for a scheduler alone.
        folder: where they keep what they need; it must be there.

    Attributes:
        certificates: what to connect with.

    Raises UsageError if certificates cannot be made.
    """

    def __init__(self, workers: int, folder: Path) -> None:
        self._count, self._folder = workers, folder
        self.certificates = Certificates.make(folder / "certificates")
        self._address = ""
        self._scheduler: subprocess.Popen[bytes] | None = None
        self._workers: subprocess.Popen[bytes] | None = None

    def start(self) -> str:
        """Start scheduler and workers, and return the scheduler's address. Raises UsageError."""
        self.close()
        file = self._folder / "scheduler.json"
        file.unlink(missing_ok=True)
        self._scheduler = self._start("scheduler", "--port", "0", "--scheduler-file", str(file))
        until = time.monotonic() + _PATIENCE
        while not file.is_file() or not file.read_bytes():
            if self._scheduler.poll() is not None or time.monotonic() > until:
                log = (self._folder / "scheduler.log").read_text(errors="replace").strip().splitlines()
                raise UsageError(f"a scheduler could not be started on this machine: {''.join(log[-1:])}")
            with interruptible():
                time.sleep(0.05)
        self._address = address_in(file)
        self._start_workers()
        return self._address

    def restart_lost_workers(self) -> bool:
        """Restart the workers if their supervising process has ended; return whether that was so."""
        if self._workers is None or self._workers.poll() is None:
            return False
        self._start_workers()
        return True

    def close(self) -> None:
        """End all processes."""
        for process in (self._workers, self._scheduler):
            if process is not None:
                _end(process)
        self._workers = self._scheduler = None

    def _start_workers(self) -> None:
        if not self._count:
            return
        self._workers = self._start(
            "worker", self._address, "--nworkers", str(self._count), "--nthreads", "1",
            "--memory-limit", "0", "--death-timeout", "60", "--local-directory", str(self._folder),
        )  # fmt: skip

    def _start(self, what: str, *arguments: str) -> subprocess.Popen[bytes]:
        own = self.certificates
        private = (
            "--protocol", "tls", "--tls-ca-file", own.ca, "--tls-cert", own.cert, "--tls-key", own.key,
            "--host", _LOOPBACK, "--no-dashboard", "--dashboard-address", f"{_LOOPBACK}:0",
        )  # fmt: skip
        with (self._folder / f"{what}.log").open("wb") as log:
            return subprocess.Popen(
                [sys.executable, "-c", _CODE.format(what=what), str(os.getpid()), *arguments, *private],
                # Dask's own folder for such files is the same for all users
                env={**_SETTINGS, **os.environ, **_PRIVATE, "DASK_TEMPORARY_DIRECTORY": str(self._folder)},
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )


def _end(process: subprocess.Popen[bytes]) -> None:
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def address_in(file: Path) -> str:
    """Return the address in a scheduler file. Raises UsageError."""
    try:
        return str(json.loads(file.read_text(encoding="utf-8"))["address"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise UsageError(
            f"{file} is not a scheduler file: `dask scheduler --scheduler-file {file}` writes one"
        ) from error


@dataclass(frozen=True, slots=True)
class Certificates:
    """Paths of files in PEM format; the holder of the key belongs to the cluster.

    Attributes:
        ca: the only certificate that the cluster trusts.
        cert: the certificate of all its processes.
        key: its private key.
    """

    ca: str
    cert: str
    key: str

    @classmethod
    def make(cls, folder: Path) -> Certificates:
        """Make new certificates, in a new folder that only this user can enter. Raises UsageError."""
        import distributed  # noqa: PLC0415  # addresses in scheduler files are read without Dask

        security: type = distributed.Security
        try:
            made = security.temporary()  # type: ignore[attr-defined]
        except ImportError as error:
            raise UsageError(
                "--cluster local:N encrypts its connections, which needs the library cryptography: "
                f"pip install 'path/to/mutabot[cluster]' ({error})"
            ) from error
        folder.mkdir(mode=0o700)
        ca = _write(folder / "certificate.pem", made.tls_ca_file)
        return cls(ca, ca, _write(folder / "key.pem", made.tls_client_key))


def _write(file: Path, text: str) -> str:
    """Write a file that is never readable by others, not even while it is being written."""
    descriptor = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    with os.fdopen(descriptor, "w", encoding="ascii") as stream:
        stream.write(text)
    return str(file)
