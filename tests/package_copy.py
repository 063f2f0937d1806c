"""A copy of the package with files dropped into it, and Python that finds this copy."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from textwrap import dedent
from types import ModuleType
from typing import Any

import mutabot

TOOLS = Path(__file__).parents[1] / "tools"


def copied(folder: Path, dropped: Mapping[str, str], of: ModuleType = mutabot) -> Path:
    """The folder, in which now is a copy of a package with these files, by their paths in the package.

    Its bytecode is copied as well, or every process would compile all of it.
    """
    package = folder / of.__name__
    shutil.copytree(Path(str(of.__file__)).parent, package)
    for name, code in dropped.items():
        file = package / name
        assert not file.exists()
        file.write_text(dedent(code), encoding="utf-8")
    return folder


def python(site: Path, *arguments: str) -> str:
    """What Python prints that finds the copy in this folder, and the project's tools."""
    done = subprocess.run(
        [sys.executable, *arguments],
        env={**os.environ, "PYTHONPATH": os.pathsep.join((str(site), str(TOOLS)))},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def mutants(site: Path, project: Path, *arguments: str) -> dict[str, Any]:
    """The mutants that the copy's command line tells, by id."""
    text = python(site, "-m", "mutabot", "-C", str(project), *arguments, "--json")
    return {mutant["id"]: mutant for mutant in json.loads(text)["mutants"]}
