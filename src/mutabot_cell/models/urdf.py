"""Reads robots from URDF files, as MuJoCo does, with the exceptions below."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike, fspath
from pathlib import Path
from xml.etree import ElementTree

import mujoco

from mutabot_cell.errors import BadModel

from .limits import Limits
from .loading import ArmModel, names_of, read_spec

# Names of meshes are paths from the file; links without joints keep their names; looks are left out.
_COMPILER = (
    '<mujoco><compiler strippath="false" fusestatic="false" discardvisual="true" meshdir="{}"/></mujoco>'
)
_PACKAGE = re.compile(r"package://([^/\"']+)/")


def read_urdf(
    path: str | PathLike[str],
    tool_link: str,
    home: Sequence[float],
    limits: Limits,
    packages: Mapping[str, str | PathLike[str]],
) -> ArmModel:
    """Read an arm from a URDF file; see `RobotModel.from_urdf`."""
    if not Path(path).is_file():
        raise BadModel(f"there is no file {fspath(path)!r}")
    text = Path(path).read_text(encoding="utf-8")
    for name in sorted(set(_PACKAGE.findall(text)) - set(packages)):
        raise BadModel(f"{path} names meshes by package://{name}/: say packages={{{name!r}: FOLDER}}")
    text = _PACKAGE.sub(lambda found: f"{Path(packages[found[1]]).resolve()}/", text)
    head, end = _opening(text, path)
    folder = Path(path).resolve().parent
    try:
        spec = mujoco.MjSpec.from_string(text[:end] + _COMPILER.format(folder) + text[end:])
    except (ValueError, mujoco.FatalError) as error:
        raise BadModel(f"MuJoCo cannot read {path}: {error}") from error
    if spec.body(tool_link) is None:
        raise BadModel(f"{path} has no link {tool_link!r}; it has {names_of(spec.bodies)}")
    read = read_spec(spec, path, tool_link, home, limits)
    return replace(read, name=head or read.name)


def _opening(text: str, path: str | PathLike[str]) -> tuple[str, int]:
    """Return the robot's name, and where its opening tag ends."""
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        # undeclared prefixes are common in these files, and MuJoCo does not mind them
        if "unbound prefix" not in str(error):
            raise BadModel(f"{path} is not well-formed: {error}") from error
        root = None
    found = re.search(r"<robot\b[^>]*>", text)
    if found is None:
        raise BadModel(f"{path} has no <robot>: is it a URDF? One with xacro must be expanded before")
    return ("" if root is None else root.get("name", "")), found.end()
