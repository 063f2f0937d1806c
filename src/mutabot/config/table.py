"""The base of tables of the configuration, also of those that packages bring."""

from __future__ import annotations

from typing import Annotated, get_origin

from pydantic import BaseModel, ConfigDict, Field

#: marks keys whose texts are paths in the project
_IN_PROJECT = "paths or patterns of files in the project"

ProjectFiles = Annotated[tuple[str, ...], Field(strict=False), _IN_PROJECT]
"""Paths or patterns of files in the project. One that matches nothing is reported as a mistake."""


class Table(BaseModel):
    """A table of the configuration.

    The text below each key, with its example, is what docs/configuration.md says.
    """

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)

    @classmethod
    def lists(cls) -> set[str]:
        """Return the keys that hold a list."""
        return {name for name, field in cls.model_fields.items() if get_origin(field.annotation) is tuple}

    @classmethod
    def paths(cls) -> list[str]:
        """Return the keys that hold ``ProjectFiles``."""
        return [name for name, field in cls.model_fields.items() if _IN_PROJECT in field.metadata]
