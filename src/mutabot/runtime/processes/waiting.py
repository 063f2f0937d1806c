"""A process below the tests that waits until something happens in it that the rest of mutabot is needed for.

Of a job without calls, most processes never reach the mutant. Such a process loads the program with the
mutant in it from code that the test process has compiled, tells that it has begun and ended, and loads
nothing else: to load all that a member needs takes longer than most programs run. As soon as it reaches the
mutant, starts or signals a process or a thread, or raises, it becomes a ``member``.

What is imported here must cost nothing: all of it has been loaded by Python itself.
"""

from __future__ import annotations

import _imp
import atexit
import builtins
import marshal
import os
import sys
import time
from importlib.machinery import SourceFileLoader

TYPE_CHECKING = False  # importing typing would take a fifth of all that this module saves
if TYPE_CHECKING:
    from types import CodeType
    from typing import Any

#: the file in the folder of the campaign's processes that tells what there is to do
FILE = "waiting"
#: audit events at which a process becomes a member
_EVENTS = {
    "_thread.start_new_thread", "os.exec", "os.fork", "os.forkpty", "os.kill", "os.killpg", "os.posix_spawn",
    "os.system", "subprocess.Popen",
}  # fmt: skip
_BEGAN = '{"type":"Began","pid":%d,"group":%d,"command":[%s],"time":%r,"test":%d}'
_ENDED = '{"type":"SessionEnd","exit_status":0,"collected":[],"errors":[]}'


def python() -> list[Any]:
    """What an interpreter must have in common with the one that has compiled the code."""
    return [sys.implementation.cache_tag, sys.flags.optimize]


def join(folder: str) -> None:
    """Wait in this process for what concerns the campaign whose processes have this folder."""
    with open(os.path.join(folder, FILE), "rb") as file:
        told = marshal.load(file)
    is_script = os.path.realpath(getattr(sys, "argv", [""])[0]) in told["codes"]  # no loader compiles it
    if told.pop("python") == python() and len(sys._current_frames()) == 1 and not is_script:
        _Waiting(folder, **told)
    else:
        from mutabot.runtime.processes.member import join as become  # noqa: PLC0415  # what is put off here

        become(folder)


class _Waiting:
    """This process, as long as nothing has happened in it.

    Args:
        folder: the folder of the campaign's processes.
        key: of the seals on events.
        codes: by the real path of a program file: the text that must stand in it, and its code with the
            mutant.
        places: numbers of the places at which the mutant is.
    """

    def __init__(
        self, folder: str, key: str, codes: dict[str, tuple[bytes, CodeType]], places: list[int]
    ) -> None:
        from _json import encode_basestring_ascii as quoted  # noqa: PLC0415  # json loads much more

        self._folder, self._key, self._codes = folder, key.encode(), codes
        self._loaded: dict[str, bytes] = {}
        self._has_become = False
        self._number = 0
        self._pid, now = os.getpid(), time.monotonic()
        self._name = f"{self._pid}-{int(now * 1e6)}"
        with open(os.path.join(folder, "now"), "rb") as file:
            test = int.from_bytes(file.read(8), sys.byteorder)
        command = ",".join(map(quoted, sys.orig_argv))
        self._tell(_BEGAN % (self._pid, os.getpgrp(), command, now, test))
        self._excepthook, self._exit, self._original = sys.excepthook, os._exit, SourceFileLoader.get_code
        sys.excepthook, os._exit = self._raised, self._leave  # type: ignore[assignment]
        atexit.register(self._end)
        if codes:
            self._place(places)
        sys.addaudithook(self._hear)

    def _place(self, places: list[int]) -> None:
        """Let the mutant stand in the program that is imported from now on."""
        switches: list[Any] = [None] * (max(places) + 1)
        for place in places:
            switches[place] = _Switch(self, place)
        vars(builtins)["__mutabot__"] = switches  # the name of model.mutant

        def get_code(loader: SourceFileLoader, name: str) -> CodeType | None:
            return self._get_code(loader, name)

        SourceFileLoader.get_code = get_code  # type: ignore[method-assign, assignment]
        runpy: Any = sys.modules.get("runpy")
        if runpy is not None:
            original = runpy._get_code_from_file

            def code_of(*arguments: Any) -> Any:  # ``runpy.run_path`` compiles files without a loader
                runpy._get_code_from_file = original
                self.become_member()
                return runpy._get_code_from_file(*arguments)

            runpy._get_code_from_file = code_of

    def _get_code(self, loader: SourceFileLoader, name: str) -> CodeType | None:
        path = loader.get_filename(name)
        real = os.path.realpath(path)
        source, code = self._codes.get(real, (b"", None))
        if code is None or self._has_become:
            return self._original(loader, name)
        if loader.get_data(path) != source:
            self.become_member()  # which tells that the file has changed
            return loader.get_code(name)
        self._loaded[real] = source
        fix_file: Any = vars(_imp)["_fix_co_filename"]  # as Python does with code that it has kept
        fix_file(code, path)
        return code

    def become_member(self) -> None:
        """Load all else, and go on as a member."""
        if self._has_become or os.getpid() != self._pid:
            return
        self._has_become = True
        if sys.excepthook == self._raised:
            sys.excepthook = self._excepthook
        if os._exit == self._leave:
            os._exit = self._exit
        SourceFileLoader.get_code = self._original  # type: ignore[method-assign]
        atexit.unregister(self._end)
        from mutabot.runtime.processes import member  # noqa: PLC0415

        member.join(self._folder, member.Begun(self._name, self._number, self._loaded))

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event in _EVENTS or (event == "import" and arguments[0] == "runpy" and self._codes):
            self.become_member()

    def _raised(self, *raised: Any) -> None:
        if not self._has_become:
            self.become_member()
            if sys.excepthook != self._raised:  # the member's, which goes on with that of before
                sys.excepthook(*raised)
                return
        self._excepthook(*raised)

    def _leave(self, status: int) -> None:
        self._end()
        (self._exit if os._exit == self._leave else os._exit)(status)

    def _end(self) -> None:
        if not self._has_become and os.getpid() == self._pid:
            self._tell(_ENDED)

    def _tell(self, text: str) -> None:
        """Write an event; the form of a line is that of ``model.event_file``."""
        from _blake2 import blake2b  # noqa: PLC0415  # hashlib loads OpenSSL

        self._number += 1
        sealing = blake2b(f"{self._name} {self._number} {text}".encode(), key=self._key, digest_size=8)
        line = f"{sealing.hexdigest()} {self._number} {text}\n".encode()
        try:
            with open(os.path.join(self._folder, f"{self._name}.jsonl"), "ab", buffering=0) as file:
                file.write(line)
        except OSError:  # what model.event_file.NOW is told then
            with open(os.path.join(self._folder, "now"), "r+b") as file:
                file.seek(8)
                file.write(b"\1")


class _Switch:
    """Stands at the mutant's place until it is reached."""

    def __init__(self, waiting: _Waiting, place: int) -> None:
        self._waiting, self._place = waiting, place

    def chosen(self) -> bool:
        """Asked at every evaluation: whether an alternative stands for the original."""
        self._waiting.become_member()
        switches = vars(builtins)["__mutabot__"]
        return bool(switches[self._place].chosen())
