"""Parameters of commands, made of classes that list the options.

A command is a function. ``context`` is a ``CommandContext``. ``request`` is the ``Request`` that is made of
the options of ``run``, or of those of another class of ``cli.options``:
``Annotated[Request, options.Planning]``. ``template`` is an option for each template, and takes the name of
the one that was chosen, and the files that it makes of the option's value. A parameter with the name of an
option in ``cli.options.Shared``, such as ``jobs``, is that option. All others are for typer to read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import wraps
from inspect import Parameter, signature
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import typer
from typer import Option

from mutabot.errors import UsageError
from mutabot.extensions import ExtensionPart, brought

from .options import Running, Shared

_DEFAULTS: Mapping[str, Any] = {"engine": "auto", "fresh": False, "operators": "all"}
#: kinds of parts of which each is an option; and what is said when two are chosen
_CHOICES = {
    "executors": "a campaign has one executor",
    "templates": "a project starts from one template",
}


def with_options(function: Callable[..., object]) -> Callable[..., object]:
    """Make a command of which typer can read the options."""
    own = signature(function, eval_str=True)
    asked = own.parameters.get("request")
    settings = _settings_of(asked)
    kind = "executors" if settings is Running else "templates" if "template" in own.parameters else ""
    found = brought(kind, Running.__annotations__) if kind else {}
    parts = {f"{kind}_{name.replace('-', '_')}": part for name, part in found.items()}
    names = [*get_type_hints(settings)] if settings is not None else []

    @wraps(function)
    def command(context: typer.Context, **values: Any) -> object:
        from .context import CommandContext  # noqa: PLC0415  # `--help` does not need it

        chosen = [(part, value) for key, part in parts.items() if (value := values.pop(key)) is not None]
        if len(chosen) > 1:
            raise UsageError(f"{' and '.join(f'--{part.name}' for part, _ in chosen)}: {_CHOICES[kind]}")
        part, value = chosen[0] if chosen else (None, "")
        if asked is not None:
            from .request import request_of  # noqa: PLC0415  # it loads what runs campaigns

            given: Any = {name: values.pop(name) for name in names}
            executor = (part.name, value) if part is not None else None
            # also of commands that only look: what they find of the original is what `run` reuses
            values["request"] = request_of(context.obj, executor=executor, evidence=True, **given)
        elif part is not None:
            values["template"] = part.name, part.load_function()(value)
        if "context" in own.parameters:
            values["context"] = CommandContext(context.obj)
        return function(**values)

    parameters = [*_parameters(own.parameters, settings), *_options(parts)]
    changed: Any = command
    changed.__signature__ = own.replace(parameters=parameters)
    changed.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return command


def _settings_of(asked: Parameter | None) -> Any:
    """Return the class of the options that make the request of a command; None if it has none."""
    if asked is None:
        return None
    return get_args(asked.annotation)[1] if get_origin(asked.annotation) is Annotated else Running


def _parameters(own: Mapping[str, Parameter], settings: Any) -> Iterator[Parameter]:
    yield Parameter("context", Parameter.KEYWORD_ONLY, annotation=typer.Context)
    shared = get_type_hints(Shared, include_extras=True)
    for name, parameter in own.items():
        if name in ("context", "request", "template"):
            continue
        hint = (
            parameter.annotation
            if get_origin(parameter.annotation) is Annotated
            else shared.get(name, parameter.annotation)
        )
        yield parameter.replace(kind=parameter.KEYWORD_ONLY, annotation=hint)
    for name, hint in get_type_hints(settings, include_extras=True).items() if settings is not None else ():
        yield Parameter(name, Parameter.KEYWORD_ONLY, default=_DEFAULTS.get(name), annotation=hint)


def _options(parts: Mapping[str, ExtensionPart]) -> Iterator[Parameter]:
    for key, part in parts.items():
        option = Option(f"--{part.name}", metavar=part.metavar, help=part.help)
        yield Parameter(key, Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[str | None, option])
