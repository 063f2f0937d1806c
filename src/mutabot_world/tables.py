"""The configuration tables for parameters of a world, in the project's configuration and in files."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from mutabot.api.processes import Table

from .onset import Onset
from .units import in_si

_TextList = Annotated[tuple[str, ...], Field(strict=False)]
_Size = Annotated[float, Field(gt=0)]
_Rising = Annotated[tuple[_Size, ...], Field(strict=False, min_length=1, max_length=40)]
_REFERENCE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_][\w.]*")


class ParameterTable(Table):
    """The table of one parameter of a world, and of how it is disturbed.

    Attributes:
        name: how reports call it.
        of: what makes worlds, ``module:Class`` or ``module:function``; empty for what the file says of all.
        path: what to change, from the world on: ``model.opt.gravity[2]``. Or:
        apply: ``module:function``, which changes it.
        names: which things of the world are meant, for functions: a name in which ``*`` stands for any text.
        options: further arguments of the function.
        change: whether magnitudes are added, are a part of what is there, or are what it becomes.
        unit: of the magnitudes.
        ladder: the magnitudes, rising.
        directions: ``+`` and ``-``; none for what is set.
        when: the moment, as ``Onset`` reads it.
        tests: node ids of the tests, in which ``*`` stands for any text; all without.
        more, less: how sentences call it, with ``{}`` for the magnitude.
    """

    name: Annotated[str, Field(min_length=1, max_length=80)]
    of: _TextList = ()
    path: str | None = None
    apply: str | None = None
    names: str = "*"
    options: dict[str, Any] = Field(default_factory=dict)
    change: Literal["offset", "scale", "set"] = "offset"
    unit: str | None = None
    ladder: _Rising
    directions: Annotated[tuple[Literal["+", "-"], ...], Field(strict=False)] = ()
    when: str = "made"
    tests: _TextList = ()
    more: str = ""
    less: str = ""

    @field_validator("name")
    @classmethod
    def _is_a_name(cls, name: str) -> str:
        if re.search(r"[:=@\n\t]", name):
            raise ValueError(f"{name!r}: a name has none of the signs : = @")
        return name

    @field_validator("of", "apply")
    @classmethod
    def _are_references(cls, found: Any) -> Any:
        for reference in (found,) if isinstance(found, str) else found or ():
            if not _REFERENCE.fullmatch(reference):
                raise ValueError(f"{reference!r} names nothing in a module; write module:name")
        return found

    @field_validator("when")
    @classmethod
    def _is_a_moment(cls, text: str) -> str:
        Onset.parse(text)
        return text

    @model_validator(mode="after")
    def _fits(self) -> ParameterTable:
        if (self.path is None) == (self.apply is None):
            raise ValueError(f"{self.name}: name what is changed, either by path or by apply")
        if tuple(sorted(set(self.ladder))) != self.ladder:
            raise ValueError(f"{self.name}: the magnitudes of a ladder must rise; they are {[*self.ladder]}")
        if self.change == "set" and self.directions:
            raise ValueError(f"{self.name}: what is set has no directions")
        if self.change == "scale" and self.unit not in (None, "percent"):
            raise ValueError(f"{self.name}: magnitudes of scale are in percent, not in {self.unit!r}")
        in_si(1.0, self.unit)  # raises for one that does not exist
        return self

    @property
    def ways(self) -> tuple[str, ...]:
        """The directions in which the parameter is disturbed; one empty direction for a value that is set."""
        return ("",) if self.change == "set" else self.directions or ("+", "-")

    @property
    def moment(self) -> Onset:
        """The moment at which the disturbance begins."""
        return Onset.parse(self.when)

    @property
    def measure(self) -> str | None:
        """The unit of the magnitudes."""
        return "percent" if self.change == "scale" else self.unit


class WorldTable(Table):
    """For [disturbances of the simulated world](world.md), which `--family world` runs."""

    parameters: _TextList = ()
    """Files with tables `[[parameter]]`: of the project, or shipped ones as `package:file`.

        parameters = ["mutabot_cell:world.toml"]
    """
    only: _TextList = ()
    """Names of the parameters to take from these files; `*` stands for any text. All without.

        only = ["part mass", "camera *"]
    """
    names: Mapping[str, str] = {}
    """Which things of the world a parameter of these files means, by its name; `*` stands for any text.

        names = { mass = "obj*" }
    """
    of: _TextList = ()
    """What makes the world of all parameters here that do not say it: `module:Class` or `module:function`.

        of = ["mutabot_cell.cell:Cell"]
    """
    parameter: Annotated[tuple[ParameterTable, ...], Field(strict=False)] = ()
    """[Parameters of the project's own](world.md#parameters-of-your-own), a table each.

        parameter = [{ name = "gravity", path = "simulation.model.opt.gravity[2]", ladder = [1] }]
    """


class ParameterFile(Table):
    """A file of parameters.

    Attributes:
        of: as for the configuration.
        parameter: the tables.
    """

    of: _TextList = ()
    parameter: Annotated[tuple[ParameterTable, ...], Field(strict=False)] = ()
