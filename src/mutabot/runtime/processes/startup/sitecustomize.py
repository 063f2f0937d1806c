"""The module that Python processes below the tests load at their start, to join a campaign when needed.

Its folder is first in ``PYTHONPATH`` while a campaign runs, so every Python of 3.8 or newer loads it in
place of a ``sitecustomize`` that may be there, which it loads then. It imports nothing that Python has not
loaded by itself. A process is of interest as soon as it runs or imports a file of the program, or imports a
module that the vocabulary names. Only then the rest of mutabot is loaded.

The file ``wake`` of the folder that the environment names says what is of interest, a line each:
``join MODULE`` with a function of that name, which is then called with the folder, ``key KEY`` of the seals,
``path FOLDER`` where packages of ours can be found, ``own NAME`` of such a package, ``name MODULE``, and
``file PATH`` of a file or folder. A process that opens such a file is of interest, as it may run what it
reads, and so is one that starts another which might not find the campaign.
"""

import os
import sys

TYPE_CHECKING = False  # importing typing would cost each process more than all else here
if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType
    from typing import Any

_VARIABLE = "MUTABOT_PROCESSES"
_NEWEST_TOO_OLD = (3, 10)
#: audit events of the start of a program, and programs that may start Python in another environment
_STARTS = ("os.system", "subprocess.Popen", "os.posix_spawn", "os.exec")
_HIDERS = ("env", "sudo", "make", "gmake")
_SHELLS = ("sh", "bash", "dash", "zsh", "ksh")


class _Finder:
    """Joins the campaign when a module of interest is imported; it finds no module itself."""

    def __init__(self, folder: str, entries: "dict[str, list[str]]") -> None:
        self.folder, self.join, self.key = folder, entries["join"][-1], entries["key"][-1]
        self.names, self.files = frozenset(entries["name"]), entries["file"]
        self.joins_for_others = sys.version_info[:2] > _NEWEST_TOO_OLD

    def find_spec(
        self, name: str, path: "Sequence[str] | None" = None, target: "ModuleType | None" = None
    ) -> "ModuleSpec | None":
        if name.partition(".")[0] not in self.names:
            return None
        _wake(self)
        # what was put before us now has not been asked
        for finder in sys.meta_path:
            found = finder.find_spec(name, path, target) if finder is not self else None
            if found is not None:
                return found
        return None

    def on_audit_event(self, event: str, arguments: "tuple[object, ...]") -> None:
        path = arguments[0] if event == "open" else None
        if isinstance(path, str) and path.endswith(".py") and self in sys.meta_path:
            if self.is_of_interest(path):
                _wake(self)
        elif (
            event in _STARTS
            and self.joins_for_others
            and self in sys.meta_path
            and _may_lose(event, arguments)
        ):
            _wake(self, is_of_interest=False)

    def is_of_interest(self, path: str) -> bool:
        real = os.path.realpath(path)
        return any(real == file or real.startswith(file.rstrip("/") + "/") for file in self.files)


class _MutabotFinder:
    """Finds mutabot's packages for an interpreter in which they are not installed."""

    def __init__(self, folders: "list[str]", names: "list[str]") -> None:
        self.folders, self.names = folders, names

    def find_spec(
        self, name: str, path: "Sequence[str] | None" = None, target: "ModuleType | None" = None
    ) -> "ModuleSpec | None":
        if path is not None or name not in self.names:
            return None
        from _frozen_importlib_external import PathFinder

        return PathFinder.find_spec(name, self.folders, target)


def _may_lose(event: str, arguments: "tuple[Any, ...]") -> bool:
    """Return whether what is about to start may not find the campaign: one that has joined sees to that."""
    command, environment = arguments[0 if event == "os.system" else 1], arguments[-1]
    try:
        if event != "os.system" and environment is not None:
            if _VARIABLE.encode() not in {os.fsencode(name) for name in environment}:
                return True
        words = [command] if isinstance(command, (str, bytes)) else command
        parts = " ".join(map(os.fsdecode, words)).split()
    except (TypeError, ValueError):  # it will not start
        return False
    names = {os.path.basename(part) for part in parts}
    if not names.isdisjoint(_HIDERS):
        return True
    text = " ".join(parts)
    if not names.isdisjoint(_SHELLS):
        return "py" in text.lower() or ".sh" in text or "./" in text
    return "python" in text and any(part[:1] == "-" and not {*part}.isdisjoint("IES") for part in parts)


def _wake(finder: _Finder, is_of_interest: bool = True) -> None:
    if finder in sys.meta_path:
        sys.meta_path.remove(finder)
    if sys.version_info[:2] <= _NEWEST_TOO_OLD:
        _report_unable(finder, "Python %d.%d is older than 3.11" % sys.version_info[:2])
        return
    try:
        __import__(finder.join, fromlist=["join"]).join(finder.folder)
    except Exception as error:
        if is_of_interest:
            _report_unable(finder, "mutabot cannot be loaded: %r" % (error,))
        else:  # it may become so
            finder.joins_for_others = False
            sys.meta_path.insert(0, finder)


def _report_unable(finder: _Finder, why: str) -> None:
    def quoted(text: str) -> str:
        return '"%s"' % "".join(
            character if character.isalnum() or character in " ._-/:()'," else "?" for character in text
        )

    command = ",".join(quoted(argument) for argument in getattr(sys, "orig_argv", sys.argv))
    name = "%d-unable" % os.getpid()
    event = '{"type":"Began","pid":%d,"group":%d,"command":[%s],"time":0.0,"unable":%s}'
    text = event % (os.getpid(), os.getpgrp(), command, quoted(why))
    try:
        import hashlib  # the form of a line is that of model.event_file

        seal = hashlib.blake2b(("%s 1 %s" % (name, text)).encode(), key=finder.key.encode(), digest_size=8)
        with open(os.path.join(finder.folder, name + ".jsonl"), "w") as file:
            file.write("%s 1 %s\n" % (seal.hexdigest(), text))
    except OSError:
        pass


def enter(command: "str | None" = None) -> None:
    """Check whether there is a campaign, and wait until the process is of interest to it.

    ``command`` is the script that it runs; by default the one that it was started with.
    """
    folder = os.environ.get(_VARIABLE)
    if not folder or any(isinstance(finder, _Finder) for finder in sys.meta_path):
        return
    try:
        wake = os.path.join(folder, "wake")
        if not os.path.isfile(wake):  # whatever was put there, do not wait for it
            return
        with open(wake, encoding="utf-8", errors="surrogateescape") as file:
            lines = [line.rstrip("\n").partition(" ") for line in file]
    except OSError:  # the campaign is over
        return
    entries: "dict[str, list[str]]" = {"join": [""], "key": [""]}
    entries.update((key, []) for key in ("path", "own", "name", "file"))
    for key, _, value in lines:
        entries[key].append(value)
    finder = _Finder(folder, entries)
    sys.meta_path.append(_MutabotFinder(entries["path"], entries["own"]))
    sys.meta_path.insert(0, finder)
    sys.addaudithook(finder.on_audit_event)
    script = command if command is not None else getattr(sys, "argv", [""])[0]
    if script and script[0] != "-" and finder.is_of_interest(script):
        _wake(finder)


def _chain(here: str) -> None:
    """Load the ``sitecustomize`` that would have been found without this one."""
    from _frozen_importlib import module_from_spec
    from _frozen_importlib_external import PathFinder

    sys.path[:] = [entry for entry in sys.path if os.path.abspath(entry) != here]
    spec = PathFinder.find_spec("sitecustomize")
    if spec is None or spec.loader is None:
        return
    module = module_from_spec(spec)
    sys.modules["sitecustomize"] = module
    spec.loader.exec_module(module)


if __name__ == "sitecustomize":
    enter()
    _chain(os.path.dirname(os.path.abspath(__file__)))
