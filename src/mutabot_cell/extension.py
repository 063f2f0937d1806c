"""What the cell brings to mutabot: its vocabulary, and the libraries whose versions decide what it does."""

from __future__ import annotations

from mutabot.extensions import Extension

EXTENSION = Extension(
    interface=1,
    vocabularies={"cell": "mutabot_cell:cell.toml"},
    versions=("mujoco", "mink", "ruckig", "numpy"),
)
