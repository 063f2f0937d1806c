"""The group of all commands: mutabot's own, and those that packages bring, imported when they are used."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import typer
from typer.core import TyperGroup

from mutabot.errors import ExtensionError
from mutabot.extensions import Part, brought

from .campaign import run
from .options import Running, with_options

#: how commands are made, whoever brings them
SETTINGS: dict[str, Any] = {
    "context_settings": {"help_option_names": ["-h", "--help"]},
    "pretty_exceptions_enable": False,
    "rich_markup_mode": None,
}


class Commands(TyperGroup):
    """The group. What packages bring is looked for when a command is none of mutabot's own, or all are told.

    A command of a package is a function from which typer can make one. Its parameter ``context`` has the
    project's folder as ``obj``. With a parameter ``executor`` and ``**given: Unpack[options.Running]`` it has
    the options of ``run``, also those of executors; ``cli.request.request_of`` makes a request of them.
    """

    def __init__(self, **given: Any) -> None:
        super().__init__(**given)
        self._brought: Mapping[str, Part] | None = None

    def list_commands(self, ctx: Any) -> list[str]:
        """All names."""
        self._look_around()
        return super().list_commands(ctx)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """The command of this name, as far as a list of all tells it; None if there is none."""
        if cmd_name not in self.commands:
            self._look_around()
        return super().get_command(ctx, cmd_name)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The name of the command that is to be run, the command, and its words."""
        name, command, rest = super().resolve_command(ctx, args)
        part = (self._brought or {}).get(str(name))
        if part is not None or name == "run":
            function = run if part is None else _function(part)
            executors = brought("executors", Running.__annotations__)
            command = _command(str(name), with_options(function, executors))
        return name, command, rest

    def _look_around(self) -> None:
        """Add the commands of packages."""
        if self._brought is None:
            self._brought = brought("commands", self.commands)
            for name, part in self._brought.items():
                self.commands[name] = _command(name, lambda: None, part.help)


def _function(part: Part) -> Callable[..., object]:
    found = part.load()
    if not callable(found):
        raise ExtensionError(f"{part.words} is no function")
    function: Callable[..., object] = found
    return function


def _command(name: str, function: Callable[..., object], help: str | None = None) -> Any:
    one = typer.Typer(add_completion=False, **SETTINGS)
    one.command(name, help=help)(function)
    return typer.main.get_command(one)
