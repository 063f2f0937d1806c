"""A source distribution holds what git tracks: a secret that lies in the folder is no part of a release."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class TrackedFilesOnly(BuildHookInterface[Any]):
    """Refuses to build where another file would get in."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compare what would be packed with what git tracks. An unpacked source distribution has no git."""
        root = Path(self.root)
        if not (root / ".git").exists():
            return
        command = ["git", "-C", os.fspath(root), "ls-files", "-z", "--cached"]
        listed = subprocess.run(command, capture_output=True, check=True).stdout
        tracked = {os.fsdecode(name) for name in listed.split(b"\0")}
        files = (file.relative_path for file in self.build_config.builder.recurse_included_files())
        strange = sorted(name for name in files if name not in tracked)
        if strange:
            raise SystemExit(
                f"a source distribution holds what git tracks, and {', '.join(strange[:8])} is not tracked: "
                "`git add` it, or move it out of the folder"
            )
