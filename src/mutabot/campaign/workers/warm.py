"""The controller's side of warm starts: the zygote that its workers are forked from."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

from mutabot.border.starter import Starter

#: what the zygote runs. It notes who imports what, and imports nothing before it does
_CODE = """
class imports:
    import builtins, sys
    bare, found, plain = tuple(sys.modules), {}, builtins.__import__
    def watch():
        imports.builtins.__import__ = imports.note
    def stop():
        imports.builtins.__import__ = imports.plain
    def note(name, globals=None, locals=None, fromlist=(), level=0):
        module = imports.plain(name, globals, locals, fromlist, level)
        if globals is not None and "__name__" in globals:
            if level:
                above = (globals.get("__package__") or "").rsplit(".", level - 1)[0]
                name = f"{above}.{name}" if name else above
            found = imports.found.setdefault(globals["__name__"], {})
            found[name] = None
            for item in fromlist or ():
                if f"{name}.{item}" in imports.sys.modules:
                    found[f"{name}.{item}"] = None
        return module
imports.watch()
from mutabot.inside.warm.zygote import main
main(imports)
"""
#: what ``site`` would run in the zygote; its processes run what they find instead
_CUSTOM = ("sitecustomize.py", "usercustomize.py")
#: seconds that it may take to end
_PATIENCE = 10.0


class WarmServer:
    """A zygote, and what is needed to start processes by it.

    Args:
        folder: where it keeps what it learns.
        root: where it begins.
        environment: that of the processes, as far as it is known.
        own: files and folders that it must import nothing from.
        own_session: whether signals from the terminal are to spare it.

    Attributes:
        starter: starts processes by it.
    """

    def __init__(
        self,
        folder: Path,
        root: Path,
        environment: Mapping[str, str],
        own: Iterable[str] = (),
        *,
        own_session: bool = True,
    ) -> None:
        blank = folder / "blank"
        blank.mkdir(parents=True, exist_ok=True)
        for name in _CUSTOM:
            (blank / name).touch()
        path = [str(blank), *filter(None, [environment.get("PYTHONPATH")])]
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-c", _CODE, str(theirs.fileno()), str(folder / "imported.txt"), *own],
                cwd=root,
                env={**environment, "PYTHONPATH": os.pathsep.join(path)},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                pass_fds=[theirs.fileno()],
                start_new_session=own_session,
            )
        self.starter = Starter(ours, may_start=True)

    def why_not(self) -> str | None:
        """Why it starts nothing, in words; None if it does, or has not been asked."""
        if self.starter.started:
            return None
        return next(iter(self.starter.refused), None)

    def close(self) -> None:
        """End it. Processes that it started go on."""
        self.starter.channel.close()
        try:
            self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self.starter.bury(_PATIENCE / 10)
