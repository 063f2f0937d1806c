"""What somebody else on this machine tries against a cluster: run as a script, perhaps as another user.

Arguments: a user's number or ``-``, the file to write by code that the cluster is made to run, the port of
the scheduler, all ports, and perhaps the files of a certificate (authority, certificate, key).
"""

from __future__ import annotations

import asyncio
import os
import sys
from typing import Any

from distributed import Client, Security
from distributed.comm import connect
from distributed.protocol.serialize import ToPickle

PATIENCE = 2.0


class Load:
    """Code that runs where this is unpickled."""

    def __init__(self, file: str) -> None:
        self.file = file

    def __reduce__(self) -> tuple[Any, ...]:
        return exec, (f"open({self.file!r}, 'a').write('ran ')",)


async def send(address: str, security: Any, file: str) -> None:
    """Send code to a port."""
    comm = await connect(address, timeout=PATIENCE, **security.get_connection_args("client"))
    await comm.write({"op": "identity", "reply": True, "load": ToPickle(Load(file))})
    await asyncio.wait_for(comm.read(), PATIENCE)


def submit(address: str, security: Any, file: str) -> None:
    """Have a function run as any client does."""
    with Client(address, security=security, timeout=PATIENCE, set_as_default=False) as client:
        client.submit(exec, f"open({file!r}, 'a').write('ran ')").result(timeout=20)


async def send_to_all(addresses: list[str], security: Any, file: str) -> None:
    tasks = [asyncio.ensure_future(send(address, security, file)) for address in addresses]
    done, _ = await asyncio.wait(tasks, timeout=5 * PATIENCE)
    for task in done:
        task.exception()


def attack(scheme: str, security: Any, file: str, scheduler: str, ports: list[str]) -> None:
    try:
        submit(f"{scheme}://127.0.0.1:{scheduler}", security, file)
    except Exception as error:
        print(f"{scheme}: {type(error).__name__}")
    addresses = [f"{scheme}://127.0.0.1:{port}" for port in ports]
    asyncio.new_event_loop().run_until_complete(send_to_all(addresses, security, file))


def main(user: str, file: str, scheduler: str, ports: str, *given: str) -> None:
    own = Security.temporary()
    if user != "-":
        os.setgroups([])
        os.setgid(int(user))
        os.setuid(int(user))
    if given:
        ca, cert, key = given
        own = Security(tls_ca_file=ca, tls_client_cert=cert, tls_client_key=key, require_encryption=True)
    else:
        attack("tcp", Security(), file, scheduler, ports.split(","))
    attack("tls", own, file, scheduler, ports.split(","))


if __name__ == "__main__":
    status = 1
    try:
        main(*sys.argv[1:])
        status = 0
    finally:
        sys.stdout.flush()
        os._exit(status)  # attempts may hang
