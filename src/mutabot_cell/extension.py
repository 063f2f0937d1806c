"""The extension by which mutabot finds this package's vocabulary, project templates and versions."""

from __future__ import annotations

from mutabot.api.faults import Described, Extension

EXTENSION = Extension(
    interface=2,
    templates={
        "cell": Described(
            "mutabot_cell.template:project",
            "Start a project: a robot in a simulated cell. gen3, ur5e, panda, xarm7, or FILE:SITE.",
            "ROBOT",
        )
    },
    vocabularies={"cell": "mutabot_cell:cell.toml"},
    versions=("mujoco", "mink", "ruckig", "numpy"),
)
