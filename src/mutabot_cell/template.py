"""A project to start from: a program for a robot in the cell, its tests, and mutabot's configuration."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from mutabot.errors import UsageError

from . import template_texts as texts

KNOWN = ("gen3", "ur5e", "panda", "xarm7")


def project(robot: str) -> Mapping[str, str]:
    """The files of a project for a robot, by their names.

    Args:
        robot: one of `KNOWN`; or FILE:SITE, an MJCF file and the site of its flange, or a URDF and its link.

    Raises:
        UsageError: it is none of these.
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
    if file.suffix not in (".xml", ".urdf") or not file.is_file() or not site:
        raise UsageError(
            f"--cell {robot}: say one of {', '.join(KNOWN)}, or FILE:SITE: an MJCF file (.xml) and the "
            "site of its flange, or a URDF (.urdf) and its last link"
        )
    is_urdf = file.suffix == ".urdf"
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
