"""A project template: a program for a robot in the cell, its tests, and mutabot's configuration."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from mutabot.api.reports import UsageError

from . import template_texts as texts
from .errors import BadModel

KNOWN = ("gen3", "ur5e", "panda", "xarm7")


def project(robot: str) -> Mapping[str, str]:
    """Return the files of a project for a robot, by their names.

    Args:
        robot: one of `KNOWN`; or FILE:SITE, an MJCF file and the site of its flange, or a URDF and its link.

    Raises:
        UsageError: it is none of these, or an MJCF file without that site.
    """
    if robot in KNOWN:
        return {
            "robot.py": texts.KNOWN_ROBOT.format(name=robot),
            "program.py": texts.CARRY,
            "tests/conftest.py": texts.CONFTEST,
            "tests/test_program.py": texts.TEST_CARRY,
            "mutabot.toml": texts.CONFIGURATION,
        }
    path, _, site = robot.rpartition(":")
    file = Path(path)
    if file.suffix not in (".xml", ".urdf") or not site:
        raise UsageError(
            f"--cell {robot}: say one of {', '.join(KNOWN)}, or FILE:SITE: an MJCF file (.xml) and the "
            "site of its flange, or a URDF (.urdf) and its last link"
        )
    is_urdf = file.suffix == ".urdf"
    if is_urdf and not file.is_file():
        raise UsageError(f"--cell {robot}: there is no file {path!r}")
    if not is_urdf:
        _check_mjcf(robot, path, site)
    return {
        "robot.py": texts.ROBOT_OF_FILE.format(
            kind="urdf" if is_urdf else "mjcf",
            path=json.dumps(str(file.resolve())),
            site="tool_link" if is_urdf else "tool_site",
            tool=json.dumps(site),
        ),
        "program.py": texts.LINE,
        "tests/conftest.py": texts.CONFTEST,
        "tests/test_program.py": texts.TEST_LINE,
        "mutabot.toml": texts.CONFIGURATION,
    }


def _check_mjcf(robot: str, path: str, site: str) -> None:
    from .models.loading import flange_of, read  # noqa: PLC0415  # it loads MuJoCo

    try:
        flange_of(read(path), path, site)
    except BadModel as error:
        raise UsageError(f"--cell {robot}: {error}") from error
