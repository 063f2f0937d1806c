"""Targets that are methods of whatever object has them: they are seen where their calls are written."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from mutabot.model import Operation
from mutabot.runtime.targets.target import Finding, Handler, Targets, Tell


class Methods(Targets):
    """Nothing is wrapped: see ``text.standing``."""

    def __init__(self, tell: Tell) -> None:
        pass

    def wrap(self, target: str, handler: Handler, overrides: Callable[[type], Handler] | None = None) -> None:
        """No callable is known to stand behind the name."""

    def remove(self) -> None:
        """There is nothing to take away."""

    def seek(self) -> Iterator[tuple[str, Finding]]:
        """There is nothing to find before it is called."""
        return iter(())

    def check(self, operation: Operation) -> Iterator[Finding]:
        """What is called tells nothing of its arguments that would hold for all."""
        return iter(())


#: what this file is, to ``interception``
KIND = Methods
