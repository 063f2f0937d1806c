"""The projects of the corpus: what most of them have alike is kept once, and stands in each copy."""

from __future__ import annotations

import shutil
from pathlib import Path

PROJECTS = Path(__file__).resolve().parent / "projects"
#: the configuration, the vocabulary and the settings of pytest of projects that have none of their own
COMMON = PROJECTS.with_name("common")
#: what is no part of a project
_IGNORED = shutil.ignore_patterns(".mutabot", "__pycache__", ".pytest_cache")


def corpus() -> list[Path]:
    """The folders of all projects of the corpus."""
    return sorted(path for path in PROJECTS.iterdir() if (path / "tests").is_dir())


def copied(folder: Path, target: Path) -> Path:
    """A complete copy of a project, also of one that is not of the corpus. Returns ``target``."""
    shutil.copytree(folder, target, ignore=_IGNORED)
    for file in COMMON.iterdir() if folder.parent == PROJECTS else ():
        if not (target / file.name).exists():
            shutil.copy(file, target)
    return target
