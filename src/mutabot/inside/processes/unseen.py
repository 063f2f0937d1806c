"""Python processes that the tests start in a way in which they do not find their way to the campaign."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from typing import Any

#: options of Python by which it leaves out the environment, or what is loaded at its start
_APART = {"-I": "the option -I", "-E": "the option -E", "-S": "the option -S"}


class Unseen:
    """Watches which processes are started.

    Args:
        tell: told the command and why nothing in it is seen, once each.
    """

    def __init__(self, tell: Callable[[str, str], None]) -> None:
        self._tell = tell
        self._told: set[str] = set()

    def watch(self) -> None:
        """Look from now on; it cannot be taken back."""
        sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event != "subprocess.Popen":
            return
        executable, command, *_ = arguments
        words = _words(executable, command)
        why = _why(words)
        name = " ".join(words[:3])
        if why is not None and name not in self._told:
            self._told.add(name)
            self._tell(name, why)


def _words(executable: Any, command: Any) -> list[str]:
    try:
        given = [command] if isinstance(command, str | bytes | os.PathLike) else list(command)
        words = [os.fsdecode(word) for word in given]
        return [os.fsdecode(executable), *words[1:]] if executable is not None else words
    except TypeError:  # it will not start either
        return []


def _why(words: Sequence[str]) -> str | None:
    if not words or not os.path.basename(words[0]).startswith("python"):
        return None
    for word in words[1:]:
        if not word.startswith("-"):
            break
        if word in _APART:
            return f"{_APART[word]} keeps it apart"
    return None
