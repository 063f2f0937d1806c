"""Check that the vocabulary fits the program: its targets exist and are used as described."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from mutabot.errors import StrangeValueError
from mutabot.model.events import Event, Problem, Remark
from mutabot.runtime.targets.callables import Callables, not_imported
from mutabot.runtime.targets.messages import Messages
from mutabot.runtime.targets.target import Finding, NotFoundError, resolve

if TYPE_CHECKING:
    from mutabot.errors import PathError
    from mutabot.model import Call, Operation, Vocabulary
    from mutabot.model.quantity import Value

#: the targets of a process
Kinds = Sequence[Callables | Messages]


class Inspection:
    """Reports each mistake in a vocabulary once.

    Args:
        vocabulary: the vocabulary to check.
        is_asked: whether to check all of it; otherwise only mistakes that come up during a run are reported.
        send: receives the problems.

    Attributes:
        elsewhere: modules that processes below the tests have, and that may not be importable here.
    """

    def __init__(self, vocabulary: Vocabulary, is_asked: bool, send: Callable[[Event], None]) -> None:
        self._vocabulary = vocabulary
        self.is_asked = is_asked
        self._send = send
        self.elsewhere: set[str] = set()
        self._reported: set[tuple[str, str]] = set()
        self._unfit: dict[tuple[str, str], Callable[[], None]] = {}
        self._fit: dict[str, set[str]] = {}

    def note(self, call: Call, read: Mapping[str, Value]) -> None:
        """Note a call, and the values that were read from its result."""
        self._fit.setdefault(call.operation.target, set()).update(read)

    def target_is_wrong(self, target: str, finding: Finding) -> None:
        """Report a target of the vocabulary that was found and does not fit."""
        self.report(self._source_of(target), finding)

    def path_is_wrong(self, operation: Operation, key: str, error: PathError) -> None:
        """Report a path that does not fit the arguments or the result of a call."""
        is_remark = isinstance(error, StrangeValueError)
        finding = Finding(key, str(error), error.step, error.known, is_remark=is_remark)

        def report_path() -> None:
            if key.partition(".")[2] not in self._fit.get(operation.target, ()):
                self.report(operation.source, finding)

        if operation.message is not None or not key.startswith("result."):
            report_path()
        elif self.is_asked:  # one result may lack what others have
            self._unfit.setdefault((operation.source, key), report_path)

    def report(self, source: str, finding: Finding) -> None:
        """Report a finding about an entry of the vocabulary, unless one was reported before."""
        if (source, finding.key) in self._reported:
            return
        self._reported.add((source, finding.key))
        problem = Problem(source, finding.key, finding.text, finding.name, finding.known)
        self._send(Remark(source, finding.key, finding.text) if finding.is_remark else problem)

    def check_target(self, operation: Operation, kinds: Kinds) -> None:
        """Report what of an operation does not fit its target."""
        for targets in kinds:
            for finding in targets.check(operation):
                self.report(operation.source, finding)

    def inspect(self, kinds: Kinds) -> None:
        """Check every target of the vocabulary that no test has reached."""
        for targets in kinds:
            for target, finding in targets.seek():
                self.report(self._source_of(target), finding)
        for operation in self._vocabulary.operations:
            self.check_target(operation, kinds)
            for targets in kinds:
                for finding in targets.unheard(operation) if isinstance(targets, Messages) else ():
                    self.report(operation.source, finding)
        for report_path in self._unfit.values():
            report_path()
        self._check_idle()
        self._check_exceptions()

    def _check_idle(self) -> None:
        """Check the functions that make the answers of commands that are left out."""
        for operation in self._vocabulary.operations:
            for idle in (operation.idle, *(pattern.idle for pattern in operation.patterns)):
                call = idle.get("call") if isinstance(idle, dict) else None
                found = self._look_up(operation.source, "idle", call) if call is not None else None
                if found is not None and not callable(found):
                    text = f"{call} is {type(found).__name__}, not a function"
                    self.report(operation.source, Finding("idle", text))

    def _check_exceptions(self) -> None:
        """Check that each refusal names an exception; a misspelt one would turn refusals into kills."""
        keys = ("refusals", "checks", "failures")
        named = [("vocabulary", key, name) for key in keys for name in getattr(self._vocabulary, key)]
        named += [
            (operation.source, "refusals", name)
            for operation in self._vocabulary.operations
            for name in operation.refusals
        ]
        for source, key, name in named:
            found = self._look_up(source, f"{key} {name}", name)
            if found is not None and not (isinstance(found, type) and issubclass(found, BaseException)):
                self.report(source, Finding(f"{key} {name}", f"{name} is not an exception class"))

    def _look_up(self, source: str, key: str, target: str) -> Any:
        """Return the object at ``module:qualified.name``; None, with a problem reported, if there is none."""
        module, _, qualname = target.partition(":")
        try:
            owner, name, _ = resolve(importlib.import_module(module), qualname)
            return getattr(owner, name)
        except NotFoundError as error:
            self.report(source, Finding(key, str(error), error.name, error.known))
        except Exception as error:  # the user's module may fail in any way; say which and how
            if module not in self.elsewhere:
                self.report(source, not_imported(module, error, key))
        return None

    def _source_of(self, target: str) -> str:
        sources = {probe.target: probe.source for probe in self._vocabulary.probes}
        if self._vocabulary.clock is not None:
            sources[self._vocabulary.clock.tick] = self._vocabulary.clock.source
        operation = self._vocabulary.operation(target)
        return operation.source if operation is not None else sources.get(target, "")
