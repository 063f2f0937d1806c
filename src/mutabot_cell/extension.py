"""What the cell brings to mutabot: its vocabulary, projects to start from, and versions that count."""

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
