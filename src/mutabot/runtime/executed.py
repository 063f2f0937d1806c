"""Record which units of the project's Python files are executed, and which files are read as text.

Files are compiled with one more statement at the beginning of each function, which sets a byte. That takes a
tenth of the time that a trace function takes (14 ns a call instead of 165), and works alike in all versions
of Python. What a test executes may leave something behind, in ways that no text shows: it counts for that
test and for all tests after it, so each test reports only what none before it has reported. See
``model.source_units``.
"""

from __future__ import annotations

import ast
import builtins
import os
import sys
from sys import _getframe
from types import CodeType, FrameType
from typing import Any

from mutabot.model.source_units import ALL_FILES, AS_TEXT, MODULE, WHOLE, Executed, functions_of
from mutabot.runtime.processes.environment import FRAMES, listen
from mutabot.runtime.program_text import loading
from mutabot.runtime.program_text.compiling import SourceStep
from mutabot.runtime.text_reads import TextReads, is_own

#: the built-in name of the bytes, one for each function
RAN = "__mutabot_ran__"
#: audit event of what runs a program in another language: a unit begins
EXECUTED = "mutabot.executed"
#: audit events of the start of a process
STARTS = {"subprocess.Popen", "os.posix_spawn", "os.system", "os.fork", "os.forkpty", "os.exec"}
#: modules whose loading means that processes are started without an event
_SPAWNERS = {"multiprocessing.popen_spawn_posix", "multiprocessing.popen_forkserver"}
_FOREIGN = {"uname", "git", "ldconfig", "lsb_release", "nvidia-smi"}
_PLACES = tuple[str, int]


class ExecutedUnits(SourceStep):
    """The executed units of this process and its forks. Files compiled without marks count as a whole.

    Args:
        root: absolute path of the project.

    Attributes:
        is_optional: loaders that compile in a way of their own may do so.
    """

    is_optional = True

    def __init__(self, root: str) -> None:
        self._reads = TextReads(root, self._note_read)
        self._name = self._reads.name
        self._ran = bytearray()
        self._places: list[_PLACES] = []
        self._common: set[_PLACES] = set()
        self._untold: set[_PLACES] = set()
        self._test: set[_PLACES] = set()
        self._loaded: set[str] = set()
        self._in_call = False

    @property
    def has_started(self) -> bool:
        """Whether a process was started outside of the tests' call phases, other than by libraries."""
        return (ALL_FILES, WHOLE) in self._common

    def install(self) -> None:
        """Start to record."""
        setattr(builtins, RAN, self._ran)
        for module in list(sys.modules.values()):  # plug-ins that pytest has imported before
            file = getattr(module, "__file__", None)
            name = self._name(file) if isinstance(file, str) else None
            if name is not None:
                self._keep({(name, WHOLE)})
        loading.add(self)
        loading.hook_pytest(self.wants, self.change)
        self._reads.install()
        listen(("import", "exec", EXECUTED, *STARTS), self._on_audit_event)

    def wants(self, path: str) -> bool:
        """Return whether a file is the project's own."""
        return path.endswith(".py") and self._name(path) is not None

    def change(self, tree: ast.Module, source: bytes, path: str) -> None:
        """Mark the functions of a file."""
        name = self._name(path)
        assert name is not None
        self._loaded.add(name)
        self._keep({(name, MODULE)})
        # it compiles functions in a way of its own
        if b"numba" in source and _imports(ast.parse(source), "numba"):
            self._keep({(name, WHOLE)})
            return
        for _, node in functions_of(tree):
            number = len(self._places)
            self._places.append((name, node.lineno))
            self._ran.append(0)
            _mark(node, number)  # what is defined in it may be sent to processes that know no marks

    def give_up(self, path: str, error: Exception) -> None:
        """Note that a file is compiled without marks, so that all of it counts once it is executed."""
        self._loaded.discard(self._name(path) or "")

    def start_test(self) -> None:
        """Begin to record a test, before its fixtures."""
        self._test.clear()

    def begin_call(self) -> None:
        """Begin the call phase of a test, after its fixtures are set up."""
        self._keep(self._take())
        self._in_call = True

    def end_call(self) -> None:
        """End the call phase of a test; what it did may matter to all tests after it."""
        if self._in_call:
            self._test |= self._take()
            self._keep(self._test)
            self._in_call = False

    def of_test(self, *, alone: bool = False) -> Executed:
        """Return new units that the running test depends on; ``alone``: only those of its call phase."""
        self.end_call()
        self._keep(self._take())
        executed = set(self._test if alone else self._untold)  # another thread may be at work
        if not alone:
            self._untold.difference_update(executed)
        found: dict[str, set[int]] = {}
        for file, line in executed:
            found.setdefault(file, set()).add(line)
        return {file: tuple(sorted(lines)) for file, lines in found.items()}

    def _keep(self, found: set[_PLACES]) -> None:
        """Count these units for all later tests."""
        self._untold.update(found - self._common)
        self._common.update(found)

    def _take(self) -> set[_PLACES]:
        """Return the functions that were executed since the last call."""
        found, number = set(), self._ran.find(1)
        while number >= 0:
            self._ran[number] = 0  # one by one: another thread may be at work
            found.add(self._places[number])
            number = self._ran.find(1, number + 1)
        return found

    def _note_read(self, name: str, is_text: bool) -> None:
        self._note({(name, WHOLE), (name, AS_TEXT)} if is_text else {(name, WHOLE)})

    def _note(self, found: set[_PLACES]) -> None:
        """Count these units for the running test, and for all later ones."""
        if self._in_call:
            self._test |= found
        else:
            self._keep(found)

    def _on_audit_event(self, event: str, arguments: tuple[Any, ...]) -> None:
        """Record an audit event that outcomes may depend on, beside executed units."""
        if event == EXECUTED:
            path, number = arguments
            name = self._name(path)
            if name is not None:
                self._note({(name, number)})
        elif event == "import" and arguments[0] in _SPAWNERS:
            self._keep({(ALL_FILES, WHOLE)})
        elif event == "exec" and isinstance(arguments[0], CodeType):
            name = self._name(arguments[0].co_filename)
            if name is not None and name not in self._loaded:
                self._keep({(name, WHOLE)})
        elif event in STARTS and not (
            is_own(_getframe(FRAMES)) or _is_foreign(event, arguments) or self._is_of_library()
        ):
            self._keep({(ALL_FILES, WHOLE)})

    def _is_of_library(self) -> bool:
        """Return whether an installed package causes the event while it is imported."""
        frame: FrameType | None = _getframe(1 + FRAMES)
        while frame is not None:
            file = frame.f_code.co_filename
            if "site-packages" in file and frame.f_code.co_name == "<module>":
                return True
            if self._name(file) is not None:
                return False
            frame = frame.f_back
        return False


def _is_foreign(event: str, arguments: tuple[Any, ...]) -> bool:
    """Return whether a program is started that runs no code of the project, such as ``uname``."""
    if event != "subprocess.Popen" or not arguments[1]:
        return False
    executable = arguments[0] or (arguments[1] if isinstance(arguments[1], str | bytes) else arguments[1][0])
    return os.path.basename(os.fsdecode(executable)) in _FOREIGN


def _mark(function: ast.FunctionDef | ast.AsyncFunctionDef, number: int) -> None:
    """Change a function so that it records its execution."""
    statement = ast.parse(f"{RAN}[{number}] = 1").body[0]
    for node in ast.walk(statement):
        if isinstance(node, ast.expr | ast.stmt):  # where no other node can stand
            node.lineno = node.end_lineno = function.lineno
            node.col_offset = node.end_col_offset = 0
    first = function.body[0]
    is_text = isinstance(first, ast.Expr) and isinstance(getattr(first.value, "value", None), str)
    function.body.insert(1 if is_text else 0, statement)


def _imports(tree: ast.Module, package: str) -> bool:
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    names = [getattr(node, "module", None) or "" for node in nodes]
    names += [alias.name for node in nodes for alias in node.names]
    return any(name.partition(".")[0] == package for name in names)
